// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a figure's table with gnuplot.
#pragma once

#include <filesystem>

#include "analysis/figure.hpp"

namespace shearcell {

/// Draws FOLDER/NAME.svg from FOLDER/NAME.csv, which write_csv() must have left there, and keeps
/// the script beside them as FOLDER/NAME.gp (`gnuplot -d NAME.gp` in that folder draws it again).
/// Returns the path of the SVG. The same table gives the same bytes with the same gnuplot.
///
/// Throws AnalysisError when gnuplot is missing, naming the package to install, or fails, with what
/// it said; the CSV and the script stay.
std::filesystem::path draw_svg(const FigureTable& table, const std::filesystem::path& folder);

}  // namespace shearcell
