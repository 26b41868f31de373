// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/plot.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/error.hpp"
#include "analysis/gnuplot_script.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell {
namespace {

/// A name is part of a script and of file names, so it may hold no character that is special in
/// either.
void require_plain_name(const std::string& name) {
  const bool plain = !name.empty() && name.front() != '-' &&
                     name.find_first_not_of(
                         "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                         "0123456789_-") == std::string::npos;
  if (!plain) throw AnalysisError("'" + name + "' cannot name a figure's files");
}

/// Runs a program with the date that it writes into its files fixed.
std::optional<ProgramOutcome> run_timeless(const std::filesystem::path& folder,
                                           const std::vector<std::string>& words) {
  return run_program(words, folder, {"SOURCE_DATE_EPOCH=0"});
}

bool made(const ProgramOutcome& outcome, const std::filesystem::path& file) {
  return outcome.code == 0 && std::filesystem::exists(file) && std::filesystem::file_size(file) > 0;
}

/// librsvg drops spaces next to a change of style unless xml:space says "preserve", which gnuplot
/// sets only for two spaces in a row.
void keep_spaces(const std::filesystem::path& svg) {
  std::ifstream in(svg, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  constexpr std::string_view plain = "<text>";
  constexpr std::string_view keeping = "<text xml:space=\"preserve\">";
  for (std::size_t at = text.find(plain); at != std::string::npos; at = text.find(plain, at)) {
    text.replace(at, plain.size(), keeping);
  }
  if (!in) throw AnalysisError("cannot read " + svg.string());
  write_output(svg, text);
}

}  // namespace

void require_own_files(const FigureTable& table, const std::filesystem::path& folder) {
  require_plain_name(table.name);
  const std::filesystem::path base = folder / table.name;
  const auto is_script = [](std::string_view beginning) {
    return beginning.starts_with(gnuplot_script_beginning);
  };
  require_ours(base.string() + ".gp", is_script);
  const bool drawn = std::filesystem::exists(base.string() + ".gp");
  FigureTable headed;
  headed.columns = table.columns;
  const std::string header = to_csv(headed);
  require_ours(base.string() + ".csv",
               [&](std::string_view beginning) { return drawn || beginning.starts_with(header); });
  for (const char* kind : {".svg", ".pdf"}) {
    require_ours(base.string() + kind, [&](std::string_view) { return drawn; });
  }
}

std::filesystem::path draw_svg(const FigureTable& table, const std::filesystem::path& folder) {
  require_plain_name(table.name);
  std::filesystem::path svg = folder / (table.name + ".svg");
  const std::filesystem::path script = folder / (table.name + ".gp");
  if (!std::filesystem::exists(folder / (table.name + ".csv"))) {
    throw AnalysisError("there is no " + table.name + ".csv in " + folder.string() + " to draw");
  }
  write_output(script, gnuplot_script(table));
  std::filesystem::remove(svg);  // gnuplot would follow a link

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
  std::filesystem::remove(pdf);  // rsvg-convert would follow a link
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
