// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a figure's table with gnuplot; PDF with librsvg.
#pragma once

#include <filesystem>
#include <optional>

#include "analysis/figure.hpp"

namespace shearcell {

/// Throws NotOurs when something that this program did not make stands where the table and its
/// drawings go: a script of ours is known by its first words, the CSV by its header or by the
/// script beside it, drawings by that script.
void require_own_files(const FigureTable& table, const std::filesystem::path& folder);

/// Draws FOLDER/NAME.svg from FOLDER/NAME.csv, which write_csv() must have left there, and keeps
/// the script beside them as FOLDER/NAME.gp (`gnuplot -d NAME.gp` in that folder draws it again).
/// Returns the path of the SVG. The same table gives the same bytes with the same gnuplot.
///
/// Throws AnalysisError when gnuplot is missing, naming the package to install, or fails, with what
/// it said; the CSV and the script stay.
std::filesystem::path draw_svg(const FigureTable& table, const std::filesystem::path& folder);

/// The same drawing as PDF beside the SVG, with no date in it: equal bytes from an equal SVG with
/// the same librsvg. Nothing where rsvg-convert (Debian package librsvg2-bin) is not installed.
/// gnuplot's own PDF would carry the time at which it was made. Throws AnalysisError when it fails.
std::optional<std::filesystem::path> convert_to_pdf(const std::filesystem::path& svg);

}  // namespace shearcell
