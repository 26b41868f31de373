// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/plot.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/error.hpp"
#include "analysis/program.hpp"

namespace shearcell {
namespace {

constexpr const char* style =
    "set encoding utf8\n"
    "set datafile separator ','\n"
    "set border 15 lw 1.2\n"
    "set xtics in mirror scale 0.9,0.5\n"
    "set ytics in mirror scale 0.9,0.5\n"
    "set format '%h'\n"
    "set mxtics 2\n"
    "set mytics 2\n"
    // Ranges end a little outside the data, not at the next tick, so that no point or bar is cut.
    "set autoscale noextend\n"
    "set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05\n"
    // Above the frame, the one place where no data can be.
    "set key above horizontal center noautotitle Left reverse samplen 1.5 width 2\n"
    "set bars 0.5\n";

// Without data there is nothing that gnuplot could draw; the axes still say what is missing.
constexpr const char* empty_plot =
    "set label 'no data' at graph 0.5, graph 0.5 center\n"
    "plot [0:1] [0:1] NaN notitle\n";

/// A name goes into a script and into file names, so it may hold only what means nothing to either.
void require_plain_name(const std::string& name) {
  const bool plain = !name.empty() && name.front() != '-' &&
                     name.find_first_not_of(
                         "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                         "0123456789_-") == std::string::npos;
  if (!plain) throw AnalysisError("'" + name + "' cannot name a figure's files");
}

/// Runs a program with the date that it writes into its files fixed.
std::optional<ProgramOutcome> run_timeless(const std::filesystem::path& folder,
                                           std::vector<std::string> words) {
  return run_program(std::move(words), folder, {"SOURCE_DATE_EPOCH=0"});
}

bool made(const ProgramOutcome& outcome, const std::filesystem::path& file) {
  return outcome.succeeded() && std::filesystem::exists(file) &&
         std::filesystem::file_size(file) > 0;
}

/// librsvg drops the space at either end of a stretch of text, where gnuplot's markup begins or
/// ends, unless it is told not to; gnuplot tells it only of two spaces together.
void keep_spaces(const std::filesystem::path& svg) {
  std::ifstream in(svg, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  constexpr std::string_view plain = "<text>";
  constexpr std::string_view keeping = "<text xml:space=\"preserve\">";
  for (std::size_t at = text.find(plain); at != std::string::npos; at = text.find(plain, at)) {
    text.replace(at, plain.size(), keeping);
  }
  std::ofstream out(svg, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  if (!in || !out) throw AnalysisError("cannot write " + svg.string());
}

}  // namespace

std::filesystem::path draw_svg(const FigureTable& table, const std::filesystem::path& folder) {
  require_plain_name(table.name);
  const std::filesystem::path svg = folder / (table.name + ".svg");
  const std::filesystem::path script = folder / (table.name + ".gp");
  if (!std::filesystem::exists(folder / (table.name + ".csv"))) {
    throw AnalysisError("there is no " + table.name + ".csv in " + folder.string() + " to draw");
  }
  std::ofstream file(script, std::ios::binary | std::ios::trunc);
  file << "set terminal svg size " << table.width << ',' << table.height
       << " enhanced font 'Helvetica,14' background '#ffffff'\n"
       << style << "set output '" << table.name << ".svg'\n"
       << "data = '" << table.name << ".csv'\n"
       << table.plot << (table.rows.empty() ? empty_plot : "") << "set output\n";
  file.close();
  if (!file) throw AnalysisError("cannot write " + script.string());

  // -d keeps a user's own defaults out of the figure.
  const std::optional<ProgramOutcome> outcome =
      run_timeless(folder, {"gnuplot", "-d", script.filename().string()});
  if (!outcome) {
    throw AnalysisError("gnuplot is not installed (Debian package gnuplot-nox); the data are in " +
                        folder.string());
  }
  if (!made(*outcome, svg)) {
    std::filesystem::remove(svg);
    throw AnalysisError("gnuplot could not draw " + table.name + ":\n" + outcome->messages);
  }
  keep_spaces(svg);
  return svg;
}

std::optional<std::filesystem::path> convert_to_pdf(const std::filesystem::path& svg) {
  std::filesystem::path pdf = svg;
  pdf.replace_extension(".pdf");
  const std::optional<ProgramOutcome> outcome =
      run_timeless(svg.parent_path(), {"rsvg-convert", "--format=pdf", "--output",
                                       pdf.filename().string(), svg.filename().string()});
  if (!outcome) return std::nullopt;
  if (!made(*outcome, pdf)) {
    std::filesystem::remove(pdf);
    throw AnalysisError("rsvg-convert could not read " + svg.string() + ":\n" + outcome->messages);
  }
  return pdf;
}

}  // namespace shearcell
