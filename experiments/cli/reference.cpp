// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/reference.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/figure.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/read_parts.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell::cli {
namespace {

/// Text for a cell of a table: '|' would end it, and a line break the table.
std::string cell(const std::string& text) {
  std::string all;
  for (const char c : text) {
    if (c == '|') all += '\\';
    all += c == '\n' ? ' ' : c;
  }
  return all;
}

std::string manifest_reference() {
  std::string text =
      "## Manifest keys\n\n"
      "At the top level ([format and examples](manifest/README.md#format)):\n\n"
      "| key | example | meaning |\n|---|---|---|\n";
  for (const ManifestKey& key : manifest_keys()) {
    text += fmt::format("| `{}` | `{}` | {} |\n", key.name, key.example, key.meaning);
  }
  return text +
         "\n## Parameters\n\n"
         "Keys of `base`, `sweep` and of each scale, in SI units. Symbols and sections are those "
         "of "
         "the\nsupplement; d is the diameter and m the mass of a grain, A_w the area of the moving "
         "wall. \"key of\"\nis the first stage whose [id](manifest/README.md#identity) depends on "
         "the "
         "parameter.\n\n" +
         schema_markdown();
}

std::string measure_reference() {
  std::string text =
      "\n## Measures\n\n"
      "Columns of `shearcell table`, which also has one for each swept parameter. Measures marked "
      "*plot* can\nstand in `plots` and `claims` of a manifest. Columns from `critical_size` on "
      "are "
      "those of `--per run`.\n\n"
      "| column | use | meaning |\n|---|---|---|\n";
  for (const TableColumn& column : table_columns(RowPer::run)) {
    const bool plots = std::ranges::any_of(
        all_scalar_measures(),
        [&](const ScalarMeasure& measure) { return measure.name == column.name; });
    text +=
        fmt::format("| `{}` | {} | {} |\n", column.name, plots ? "plot" : "", cell(column.meaning));
  }
  text +=
      "\nCurves, of `shearcell table --curve` and as `y` of `plots`:\n\n"
      "| curve | against | meaning |\n|---|---|---|\n";
  for (const CurveMeasure& curve : all_curve_measures()) {
    text += fmt::format("| `{}` | `{}` | {} |\n", curve.name, curve.x,
                        cell(std::string(curve.meaning)));
  }
  return text;
}

std::string figure_reference() {
  std::string text =
      "\n## Figures\n\n"
      "[Panels and sources](../analysis/README.md#figures).\n\n"
      "| figure | shows | keys that its experiment varies |\n|---|---|---|\n";
  for (const Figure& figure : all_figures()) {
    text += fmt::format("| `{}` | {} | {} |\n", figure.name, cell(figure.title),
                        cell(fmt::format("{}", fmt::join(figure.keys, ", "))));
  }
  return text;
}

std::string option_row(const OptionEntry& option) {
  std::string words = fmt::format("{}", fmt::join(option.names, ", "));
  if (!option.placeholder.empty()) words += (words.empty() ? "" : " ") + option.placeholder;
  return fmt::format("| `{}` | {} |\n", cell(words), cell(option.meaning));
}

std::string command_reference(const CommandEntry& command) {
  std::string text = fmt::format("\n### {}\n\n{}.\n", spoken(command), command.meaning);
  std::string rows;
  for (const OptionEntry& option : command.positionals) rows += option_row(option);
  for (const OptionEntry& option : command.options) {
    if (option.names.back() != "--help") rows += option_row(option);
  }
  if (!rows.empty()) text += "\n| argument | meaning |\n|---|---|\n" + rows;
  // The columns and figures, which have tables of their own above, are not listed again.
  const bool listed = command.path.back() == "table" || command.path.back() == "figures";
  if (!command.footer.empty() && !listed) {
    text += fmt::format("\n```text\n{}\n```\n", command.footer);
  }
  return text;
}

}  // namespace

std::string reference_markdown(const std::vector<CommandEntry>& tree) {
  std::string text =
      "# Reference\n\n"
      "`shearcell manual --markdown` prints this file from the program's own tables; a test "
      "compares them.\n\n" +
      manifest_reference() + measure_reference() + figure_reference() +
      "\n## Commands\n\n"
      "Every command takes `--help`. `SHEARCELL_STORE` names the store where `--store` does not; "
      "`NO_COLOR` turns\ncolours off.\n";
  for (std::size_t k = 1; k < tree.size(); ++k) text += command_reference(tree[k]);
  return text +
         fmt::format("\n## Examples and exit codes\n\n```text\n{}\n```\n", tree.front().footer);
}

}  // namespace shearcell::cli
