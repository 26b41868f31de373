// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/plot.hpp"

#include <string>
#include <string_view>
#include <utility>

#include "analysis/error.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

/// The name is part of a script and of file names: it may only have characters that are special in
/// neither.
void require_plain_name(const std::string& name) {
  const bool plain = !name.empty() && name.front() != '-' &&
                     name.find_first_not_of(
                         "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                         "0123456789_-") == std::string::npos;
  if (!plain) throw AnalysisError("'" + name + "' cannot name a figure's files");
}

/// Programs write this date into their files, whenever they run.
constexpr const char* fixed_date = "SOURCE_DATE_EPOCH=0";

/// What a program drew; nothing when it failed.
std::optional<std::string> drawing(const ProgramOutcome& outcome,
                                   const std::filesystem::path& file) {
  constexpr std::size_t most_bytes = std::size_t{1} << 30;
  auto text = read_plain(file, most_bytes);
  if (outcome.code != 0 || (text && text->empty())) text.reset();
  return text;
}

/// librsvg drops spaces next to a change of style unless xml:space says "preserve", which gnuplot
/// sets only for two spaces in a row.
std::string with_spaces_kept(std::string text) {
  constexpr std::string_view plain = "<text>";
  constexpr std::string_view keeping = "<text xml:space=\"preserve\">";
  for (std::size_t at = text.find(plain); at != std::string::npos; at = text.find(plain, at)) {
    text.replace(at, plain.size(), keeping);
  }
  return text;
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
  std::filesystem::path svg = folder / (table.name + ".svg"), pdf = folder / (table.name + ".pdf");
  const std::string script = table.name + ".gp";
  write_output(folder / script, gnuplot_script(table));
  const TemporaryFolder apart;
  write_output(apart.path() / script, gnuplot_script(table));

  // -d: without the user's own settings.
  const std::optional<ProgramOutcome> outcome =
      run_program({"gnuplot", "-d", script}, apart.path(), {fixed_date});
  auto drawn = outcome ? drawing(*outcome, apart.path() / svg.filename()) : std::nullopt;
  if (!drawn) {  // older drawings show other data
    for (const auto& old : {svg, pdf}) std::filesystem::remove(old);
  }
  if (!outcome) {
    throw AnalysisError("gnuplot is not installed (Debian package gnuplot-nox); the data are in " +
                        folder.string());
  }
  if (!drawn) {
    throw AnalysisError("gnuplot could not draw " + table.name + ":\n" + outcome->messages);
  }
  write_output(svg, with_spaces_kept(std::move(*drawn)));
  return svg;
}

std::optional<std::filesystem::path> convert_to_pdf(const std::filesystem::path& svg) {
  std::filesystem::path pdf = svg;
  pdf.replace_extension(".pdf");
  const TemporaryFolder apart;
  const std::filesystem::path made = apart.path() / pdf.filename();
  const std::optional<ProgramOutcome> outcome = run_program(
      {"rsvg-convert", "--format=pdf", "--output", made.string(), svg.filename().string()},
      svg.parent_path(), {fixed_date});
  const auto drawn = outcome ? drawing(*outcome, made) : std::nullopt;
  if (!drawn) std::filesystem::remove(pdf);  // it shows other data
  if (!outcome) return std::nullopt;
  if (!drawn) {
    throw AnalysisError("rsvg-convert could not read " + svg.string() + ":\n" + outcome->messages);
  }
  write_output(pdf, *drawn);
  return pdf;
}

}  // namespace shearcell
