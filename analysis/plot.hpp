// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a table as SVG with gnuplot and converts the SVG to PDF with librsvg.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "analysis/chart.hpp"

namespace shearcell {

/// The gnuplot commands (gnuplot_script.cpp) that write NAME.svg into the current folder. The data
/// points are part of the commands. A chart without points has axes and the words "no data". The
/// same table gives the same bytes.
std::string gnuplot_script(const Table& table);

/// The first words of every script.
inline constexpr std::string_view gnuplot_script_beginning = "set terminal svg size ";

/// Throws NotOurs if drawing the table would overwrite a file that this program did not write.
/// A script is recognized by its first words. A drawing is recognized by a script that has the same
/// name, and a CSV file by its header or by such a script.
void require_own_files(const Table& table, const std::filesystem::path& folder);

/// Draws FOLDER/NAME.svg and keeps the script as FOLDER/NAME.gp (`gnuplot -d NAME.gp` draws it
/// again). Returns the path of the SVG. The same table gives the same bytes with the same gnuplot.
/// The drawing is written to FOLDER only after gnuplot has completed it in memory. Therefore
/// several programs may write to one folder, and no truncated file is left there.
///
/// Throws AnalysisError if gnuplot is not installed, fails or writes an incomplete drawing. The
/// error names the package to install, or repeats gnuplot's message. After such an error
/// the script is kept, and older drawings with this name are deleted, because they show other data.
std::filesystem::path draw_svg(const Table& table, const std::filesystem::path& folder);

/// Converts the SVG to a PDF in the same folder and returns the path of the PDF. The same SVG gives
/// the same bytes with the same librsvg. gnuplot is not used for this, because its PDFs contain the
/// time of writing. Returns nothing if rsvg-convert (Debian package librsvg2-bin) is not installed.
/// Throws AnalysisError if rsvg-convert fails or writes an incomplete file.
std::optional<std::filesystem::path> convert_to_pdf(const std::filesystem::path& svg);

}  // namespace shearcell
