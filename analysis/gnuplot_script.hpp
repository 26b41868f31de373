// SPDX-License-Identifier: GPL-3.0-or-later
// The gnuplot commands that draw a table.
#pragma once

#include <string>
#include <string_view>

#include "analysis/chart.hpp"

namespace shearcell {

/// How every script begins.
inline constexpr std::string_view gnuplot_script_beginning = "set terminal svg size ";

/// A script that writes NAME.svg into the current folder. It holds the points that it draws. A
/// chart without points gets its axes and the words "no data". The same table gives the same bytes.
std::string gnuplot_script(const FigureTable& table);

}  // namespace shearcell
