// SPDX-License-Identifier: GPL-3.0-or-later
// `manual`: the manual page, in roff, from the same texts as --help; or the reference, in Markdown.
#include <fmt/format.h>

#include <memory>

#include "experiments/cli/command.hpp"
#include "experiments/cli/command_tree.hpp"
#include "experiments/cli/reference.hpp"
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
    } else {
      all += c;
    }
  }
  return all;
}

std::string option_text(const OptionEntry& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + name;
  const bool positional = option.names.empty();
  return fmt::format(
      ".TP\n.B {}\n{}\n",
      escaped(positional ? option.placeholder
                         : names + (option.placeholder.empty() ? "" : " " + option.placeholder)),
      escaped(option.meaning));
}

std::string section(const CommandEntry& command) {
  std::string text;
  if (!command.path.empty()) {
    text += fmt::format(".SS {}\n{}\n", escaped(spoken(command)), escaped(command.meaning));
  }
  for (const OptionEntry& option : command.positionals) text += option_text(option);
  for (const OptionEntry& option : command.options) text += option_text(option);
  if (!command.path.empty() && !command.footer.empty()) {
    text += fmt::format(".PP\n.nf\n{}\n.fi\n", escaped(command.footer));
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
      escaped(host_facts().at("build").at("version").get<std::string>()), escaped(program.meaning));
  text += section(program) + ".SH COMMANDS\n";
  for (std::size_t i = 1; i < tree.size(); ++i) text += section(tree[i]);
  return text +
         ".SH ENVIRONMENT\n"
         ".TP\n.B SHEARCELL_STORE\nfolder of the store where \\-\\-store does not name it\n"
         ".TP\n.B NO_COLOR\nset to anything: no colours\n"
         ".SH EXAMPLES AND EXIT CODES\n.nf\n" +
         escaped(program.footer) + "\n.fi\n";
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
    fmt::print("{}", *markdown ? reference_markdown(tree) : manual(tree));
  });
}

}  // namespace shearcell::cli
