// SPDX-License-Identifier: GPL-3.0-or-later
// `manual`: prints the reference (experiments/REFERENCE.md), generated from the program's tables,
// commands and options. experiments/install makes the manual pages from the output of --help.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>

#include "analysis/estimators.hpp"
#include "analysis/figure.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/shipped.hpp"

namespace shearcell::cli {
namespace {

constexpr std::size_t kLongestChoice = 60;

/// Returns how to write an option, such as "--jobs, -j J", or the name of a positional argument.
std::string usage(const CLI::Option& option) {
  const std::string names = CLI::detail::find_and_replace(option.get_name(false, true), ",", ", ");
  if (option.get_items_expected_max() == 0) return names;
  if (option.get_positional()) return option.get_single_name();
  std::string value = option.get_type_name();
  if (const auto choices = value.find(":{"); choices != std::string::npos) {
    std::string one_of = value.substr(choices + 2);
    one_of.pop_back();
    std::ranges::replace(one_of, ',', '|');
    value.erase(choices);
    if (one_of.size() <= kLongestChoice) value = one_of;  // longer lists are left out
  }
  return names + " " + (value.empty() ? "VALUE" : value);
}

/// Escapes text for a cell of a Markdown table.
std::string cell(std::string_view text) {
  const std::string line = boost::replace_all_copy(std::string(text), "\n", " ");
  return boost::replace_all_copy(line, "|", "\\|");
}

std::string manifest_reference() {
  return "## Manifest keys\n\n"
         "Keys at the top level ([format and examples](manifest/README.md#format)):\n\n" +
         manifest_markdown() + R"(
## Parameters

These keys can be used in `base`, in `sweep` and in each scale. Values are in SI units. Symbols and
sections refer to the supplement: d is the diameter of a grain, m the mass of a grain, and A_w the
area of the moving wall. The column "key of" names the first stage whose
[id](manifest/README.md#identity) depends on the parameter.

)" + schema_markdown();
}

std::string measure_reference() {
  std::string text = R"(
## Measures

These are the columns of `shearcell table`, which also has one column for each swept parameter.
Measures marked *plot* can be used in `plots` and `claims` of a manifest. Measures marked *until*
can also be used in `until`. `critical_size` and all columns below it need `--per run`.

| column | use | meaning |
|---|---|---|
)";
  for (const TableColumn& column : table_columns()) {
    const bool plots = find_measure(column.name) != nullptr ||
                       find_measure(column.name, MeasureKind::run) != nullptr;
    const char* until = can_be_until(column.name) ? ", until" : "";
    text += fmt::format("| `{}` | {}{} | {} |\n", column.name, plots ? "plot" : "", until,
                        cell(column.meaning));
  }
  text +=
      "\nCurves for `shearcell table --curve` and for `y` of `plots`:\n\n"
      "| curve | function of | meaning |\n|---|---|---|\n";
  for (const Measure* curve : all_measures(MeasureKind::curve)) {
    text += fmt::format("| `{}` | `{}` | {} |\n", curve->name, curve->x, cell(curve->meaning));
  }
  text +=
      "\nMeasures of each grain, in exports and in the packings of the report:\n\n"
      "| measure | unit | meaning |\n|---|---|---|\n";
  for (const Measure* one : all_measures(MeasureKind::grains)) {
    text += fmt::format("| `{}` | {} | {} |\n", one->name, one->unit, cell(one->meaning));
  }
  return text;
}

std::string estimator_reference() {
  std::string text =
      "\n## Estimators\n\n"
      "Values of `estimator` in a claim, and the other key that each value requires.\n\n"
      "| estimator | key | number |\n|---|---|---|\n";
  for (const Estimator& one : all_estimators()) {
    const std::string key = one.key.empty() ? "" : fmt::format("`{}`", one.key);
    text += fmt::format("| `{}` | {} | {} |\n", one.name, key, cell(one.meaning));
  }
  return text;
}

std::string figure_reference() {
  std::string text =
      "\n## Figures\n\n"
      "[How figures are made](../analysis/README.md#figures).\n\n"
      "| figure | shows | keys that the experiment varies |\n|---|---|---|\n";
  for (const Figure& figure : all_figures()) {
    text += fmt::format("| `{}` | {} | {} |\n", figure.name, cell(figure.title),
                        cell(fmt::format("{}", fmt::join(figure.keys, ", "))));
  }
  return text;
}

/// Describes the command and then its subcommands. `path`: full name, such as "shearcell bench".
std::string command_reference(const CLI::App& command, const std::string& path) {
  std::string text = fmt::format("\n### {}\n\n{}.\n", path, command.get_description());
  std::string positionals, options;
  for (const CLI::Option* option : command.get_options()) {
    if (option == command.get_help_ptr()) continue;
    std::string meaning = option->get_description();
    if (const std::string value = option->get_default_str(); !value.empty()) {
      meaning += fmt::format(" (default: {})", value);
    }
    (option->get_positional() ? positionals : options) +=
        fmt::format("| `{}` | {} |\n", cell(usage(*option)), cell(meaning));
  }
  if (const std::string rows = positionals + options; !rows.empty()) {
    text += "\n| argument | meaning |\n|---|---|\n" + rows;
  }
  // Leaves out the help texts of `table` and `figures`, because the sections Measures and Figures
  // contain the same lists.
  const bool listed = command.get_name() == "table" || command.get_name() == "figures";
  if (!command.get_footer().empty() && !listed) {
    text += fmt::format("\n```text\n{}\n```\n", command.get_footer());
  }
  for (const CLI::App* sub : command.get_subcommands({})) {
    text += command_reference(*sub, path + " " + sub->get_name());
  }
  return text;
}

/// The text that experiments/REFERENCE.md must have. The test docs.reference checks the file.
std::string reference(const CLI::App& program) {
  std::string text =
      "# Reference\n\n"
      "`shearcell manual` prints this file from the program's own tables. A test compares the "
      "output with this file.\n\n" +
      manifest_reference() + measure_reference() + estimator_reference() + figure_reference() +
      "\n## Commands\n\n"
      "Every command has `--help`. The environment variable `SHEARCELL_STORE` names the store if "
      "`--store` is not\ngiven, `SHEARCELL_LAMMPS` names the LAMMPS program to use instead of "
      "`lmp` "
      "on PATH, and `NO_COLOR`\nturns colours off.\n";
  for (const CLI::App* command : program.get_subcommands({})) {
    text += command_reference(*command, "shearcell " + command->get_name());
  }
  return text +
         fmt::format("\n## Examples and exit codes\n\n```text\n{}\n```\n", program.get_footer());
}

}  // namespace

void add_manual(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand(
      "manual", "Print the reference of manifest keys, measures and commands, in Markdown");
  command->add_flag("--markdown")->description("No effect: the manual is always in Markdown");
  command->footer("Example:\n  shearcell manual > reference.md");
  command->callback([&app] { fmt::print("{}", reference(app)); });
}

}  // namespace shearcell::cli
