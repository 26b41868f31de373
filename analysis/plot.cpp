// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/plot.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string/replace.hpp>
#include <string_view>

#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

/// Makes programs write a fixed date into their files.
constexpr const char* fixed_date = "SOURCE_DATE_EPOCH=0";

/// Returns why the program's standard output is not a complete drawing; "" if it is complete. A
/// complete drawing begins with `begins` and ends with `ends`.
std::string fault_of(const char* program, const ProgramOutcome& outcome,
                     const std::filesystem::path& file, std::string_view begins,
                     std::string_view ends) {
  constexpr int signal = 128;
  std::string_view drawn = outcome.output;
  drawn = drawn.substr(0, drawn.find_last_not_of(" \r\n") + 1);
  std::string fault;
  if (outcome.code > signal) {
    fault = fmt::format("was ended by signal {}", outcome.code - signal);
  } else if (outcome.code != 0) {
    fault = fmt::format("ended with code {}", outcome.code);
  } else if (!drawn.starts_with(begins) || !drawn.ends_with(ends)) {
    fault = fmt::format("wrote {} bytes; a complete file begins with {} and ends with {}",
                        drawn.size(), begins, ends);
  } else {
    return "";
  }
  return fmt::format("{} could not draw {}: it {}{}{}", program, file.filename().string(), fault,
                     outcome.messages.empty() ? "" : ":\n", outcome.messages);
}

}  // namespace

void require_own_files(const Table& table, const std::filesystem::path& folder) {
  const std::filesystem::path base = folder / table.name;
  const auto is_script = [](std::string_view beginning) {
    return beginning.starts_with(gnuplot_script_beginning);
  };
  require_ours(base.string() + ".gp", is_script);
  const bool drawn = std::filesystem::exists(base.string() + ".gp");
  Table headed;
  headed.columns = table.columns;
  const std::string header = to_csv(headed);
  require_ours(base.string() + ".csv",
               [&](std::string_view beginning) { return drawn || beginning.starts_with(header); });
  for (const char* kind : {".svg", ".pdf"}) {
    require_ours(base.string() + kind, [&](std::string_view) { return drawn; });
  }
}

std::filesystem::path draw_svg(const Table& table, const std::filesystem::path& folder) {
  std::filesystem::path svg = folder / (table.name + ".svg"), pdf = folder / (table.name + ".pdf");
  const std::string script = table.name + ".gp";
  const TemporaryFolder apart;
  write_output(apart.path() / script, gnuplot_script(table));
  write_output(folder / script, gnuplot_script(table));
  // This link sends the drawing to standard output, which is kept in memory. If gnuplot wrote a
  // file to a full disk, it would truncate the file and exit with code 0.
  std::filesystem::create_symlink("/dev/stdout", apart.path() / svg.filename());
  // With -d, gnuplot ignores the user's settings.
  const std::optional<ProgramOutcome> outcome =
      run_program({"gnuplot", "-d", script}, apart.path(), {fixed_date});
  const std::string fault = outcome ? fault_of("gnuplot", *outcome, svg, "<?xml", "</svg>")
                                    : "gnuplot is not installed (Debian package gnuplot-nox)";
  if (!fault.empty()) {  // delete the drawings of an earlier call, which show other data
    for (const auto& old : {svg, pdf}) std::filesystem::remove(old);
    throw AnalysisError(fault);
  }
  std::string drawn = outcome->output;
  // librsvg drops spaces next to a change of style unless xml:space says "preserve", which gnuplot
  // sets only for two spaces in a row.
  boost::replace_all(drawn, "<text>", "<text xml:space=\"preserve\">");
  boost::replace_all(drawn, "]]>",
                     "]]&gt;");  // XML forbids ]]> in text, but gnuplot writes it
  write_output(svg, drawn);
  return svg;
}

std::optional<std::filesystem::path> convert_to_pdf(const std::filesystem::path& svg) {
  std::filesystem::path pdf = svg;
  pdf.replace_extension(".pdf");
  const std::optional<ProgramOutcome> outcome = run_program(
      {"rsvg-convert", "--format=pdf", svg.filename().string()}, svg.parent_path(), {fixed_date});
  const std::string fault =
      outcome ? fault_of("rsvg-convert", *outcome, pdf, "%PDF-", "%%EOF") : "";
  if (!outcome || !fault.empty()) std::filesystem::remove(pdf);  // an older PDF shows other data
  if (!fault.empty()) throw AnalysisError(fault);
  if (!outcome) return std::nullopt;
  write_output(pdf, outcome->output);
  return pdf;
}

}  // namespace shearcell
