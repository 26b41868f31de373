// SPDX-License-Identifier: GPL-3.0-or-later
// The gnuplot commands that draw a table from its CSV file.
#pragma once

#include <string>
#include <string_view>

#include "analysis/chart.hpp"

namespace shearcell {

/// How every script begins.
inline constexpr std::string_view gnuplot_script_beginning = "set terminal svg size ";

/// A script that reads NAME.csv and writes NAME.svg, both in the current folder. A chart whose
/// series have no point gets its axes and the words "no data". The same table gives the same bytes.
std::string gnuplot_script(const FigureTable& table);

}  // namespace shearcell
