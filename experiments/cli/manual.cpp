// SPDX-License-Identifier: GPL-3.0-or-later
// `manual`: texts generated from the parser's commands and options.
//   manual              the manual page, in roff, from the same texts as --help
//   manual --markdown   the reference, experiments/REFERENCE.md
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "analysis/figure.hpp"
#include "analysis/onset.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/cli/command_tree.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/runner/host.hpp"

namespace shearcell::cli {
namespace {

/// Text for roff: no line may begin with a control character, and hyphens stay hyphens.
std::string escaped(const std::string& text) {
  std::string all;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) all += "\\&";
    line_begins = c == '\n';
    if (c == '\\') {
      all += "\\e";
    } else if (c == '-') {
      all += "\\-";
    } else if (c == '|') {
      all += "|\\:";  // a line may end here
    } else {
      all += c;
    }
  }
  return all;
}

/// "--jobs, -j J"; for a positional "manifest".
std::string usage(const OptionEntry& option) {
  const bool spaced = !option.names.empty() && !option.placeholder.empty();
  return fmt::format("{}{}{}", fmt::join(option.names, ", "), spaced ? " " : "",
                     option.placeholder);
}

std::string section(const CommandEntry& command) {
  std::string text;
  if (!command.path.empty()) {
    text += fmt::format(".SS {}\n{}\n", escaped(spoken(command)),
                        escaped(command.app->get_description()));
  }
  for (const OptionEntry& option : command.options) {
    text += fmt::format(".TP\n.B {}\n{}\n", escaped(usage(option)), escaped(option.meaning));
  }
  if (!command.path.empty() && !command.app->get_footer().empty()) {
    text += fmt::format(".PP\n.nf\n{}\n.fi\n", escaped(command.app->get_footer()));
  }
  return text;
}

std::string manual(const std::vector<CommandEntry>& tree) {
  const CommandEntry& program = tree.front();
  std::string text = fmt::format(
      ".TH SHEARCELL 1 \"\" \"shearcell {}\" \"User Commands\"\n"
      ".SH NAME\nshearcell \\- discrete element experiments on cyclically sheared grains\n"
      ".SH SYNOPSIS\n.B shearcell\n.I command\n[\\fIoptions\\fR]\n"
      ".SH DESCRIPTION\n{}\n.SH OPTIONS\n",
      escaped(host_facts().at("build").at("version").get<std::string>()),
      escaped(program.app->get_description()));
  text += section(program) + ".SH COMMANDS\n";
  for (std::size_t i = 1; i < tree.size(); ++i) text += section(tree[i]);
  return text +
         ".SH ENVIRONMENT\n"
         ".TP\n.B SHEARCELL_STORE\nfolder of the store where \\-\\-store does not name it\n"
         ".TP\n.B SHEARCELL_LAMMPS\nthe LAMMPS program to use instead of lmp on PATH\n"
         ".TP\n.B NO_COLOR\nset to anything: no colours\n"
         ".SH EXAMPLES AND EXIT CODES\n.nf\n" +
         escaped(program.app->get_footer()) + "\n.fi\n";
}

// --- The reference, which also lists manifest keys, measures and figures ---

/// Escapes text for a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string all;
  for (const char c : text) {
    if (c == '|') all += '\\';
    all += c == '\n' ? ' ' : c;
  }
  return all;
}

std::string manifest_reference() {
  return "## Manifest keys\n\n"
         "At the top level ([format and examples](manifest/README.md#format)):\n\n" +
         manifest_markdown() + R"(
## Parameters

Keys of `base`, `sweep` and of each scale, in SI units. Symbols and sections are those of the
supplement; d is the diameter and m the mass of a grain, A_w the area of the moving wall. "key of"
is the first stage whose [id](manifest/README.md#identity) depends on the parameter.

)" + schema_markdown();
}

std::string measure_reference() {
  std::string text = R"(
## Measures

Columns of `shearcell table`, which also has one for each swept parameter. Measures marked *plot* can
stand in `plots` and `claims` of a manifest. Columns from `critical_size` on are those of `--per run`.

| column | use | meaning |
|---|---|---|
)";
  for (const TableColumn& column : table_columns()) {
    const bool plots =
        find_measure(column.name) != nullptr || find_run_measure(column.name) != nullptr;
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

std::string command_reference(const CommandEntry& command) {
  std::string text =
      fmt::format("\n### {}\n\n{}.\n", spoken(command), command.app->get_description());
  std::string rows;
  for (const OptionEntry& option : command.options) {
    if (!option.names.empty() && option.names.back() == "--help") continue;
    rows += fmt::format("| `{}` | {} |\n", cell(usage(option)), cell(option.meaning));
  }
  if (!rows.empty()) text += "\n| argument | meaning |\n|---|---|\n" + rows;
  // The help texts of these two list columns and figures, which the reference lists above.
  const bool listed = command.path.back() == "table" || command.path.back() == "figures";
  if (!command.app->get_footer().empty() && !listed) {
    text += fmt::format("\n```text\n{}\n```\n", command.app->get_footer());
  }
  return text;
}

/// The text of experiments/REFERENCE.md (test docs.reference).
std::string reference(const std::vector<CommandEntry>& tree) {
  std::string text =
      "# Reference\n\n"
      "`shearcell manual --markdown` prints this file from the program's own tables; a test "
      "compares them.\n\n" +
      manifest_reference() + measure_reference() + figure_reference() +
      "\n## Commands\n\n"
      "Every command takes `--help`. `SHEARCELL_STORE` names the store where `--store` does not, "
      "`SHEARCELL_LAMMPS`\nthe LAMMPS program to use instead of `lmp` on PATH; `NO_COLOR` turns "
      "colours off.\n";
  for (std::size_t k = 1; k < tree.size(); ++k) text += command_reference(tree[k]);
  return text + fmt::format("\n## Examples and exit codes\n\n```text\n{}\n```\n",
                            tree.front().app->get_footer());
}

}  // namespace

void add_manual(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand("manual", "Print the manual page, in roff");
  auto markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *markdown,
                    "Print the reference of manifest keys, measures and commands instead");
  command->footer(
      "Examples:\n  shearcell manual | man -l -\n  shearcell manual --markdown > reference.md");
  command->callback([&app, markdown] {
    const std::vector<CommandEntry> tree = command_tree(app);
    fmt::print("{}", *markdown ? reference(tree) : manual(tree));
  });
}

}  // namespace shearcell::cli
