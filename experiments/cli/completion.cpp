// SPDX-License-Identifier: GPL-3.0-or-later
// `completion`: scripts with which a shell completes commands, options and paths, generated from
// the parser's commands and options.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "experiments/cli/command.hpp"
#include "experiments/cli/command_tree.hpp"
#include "provenance/io/child_process.hpp"

namespace shearcell::cli {
namespace {

std::string option_words(const CommandEntry& command) {
  std::vector<std::string> names;
  for (const OptionEntry& option : command.options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return fmt::format("{}", fmt::join(names, " "));
}

std::string subcommand_words(const CommandEntry& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.subcommands()) names.push_back(sub->get_name());
  return fmt::format("{}", fmt::join(names, " "));
}

std::string bash(const std::vector<CommandEntry>& tree) {
  std::string cases;
  for (const CommandEntry& command : tree) {
    cases +=
        fmt::format("    {}) commands={}; options={} ;;\n",
                    shell_quoted(fmt::format("{}", fmt::join(command.path, " "))),
                    shell_quoted(subcommand_words(command)), shell_quoted(option_words(command)));
  }
  return fmt::format(
      R"(# bash completion for shearcell: source it, or put it where bash-completion looks.
_shearcell() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} path='' commands='' options='' word
  _shearcell_words ''
  for word in "${{COMP_WORDS[@]:1:$((COMP_CWORD - 1))}}"; do
    case " $commands " in *" $word "*)
      path=${{path:+$path }}$word; _shearcell_words "$path" ;;
    esac
  done
  if [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$current"))
  elif [[ -n $commands ]]; then
    COMPREPLY=($(compgen -W "$commands" -- "$current"))
  else
    local IFS=$'\n'
      COMPREPLY=($(compgen -f -- "$current"))
  fi
}}
_shearcell_words() {{
  case $1 in
{}  esac
}}
complete -o filenames -F _shearcell shearcell
)",
      cases);
}

std::string fish(const std::vector<CommandEntry>& tree) {
  std::string all = "# fish completion for shearcell\n";
  for (const CommandEntry& command : tree) {
    std::string here;  // condition: this command was typed, without a subcommand
    for (const std::string& word : command.path) {
      here += fmt::format("{}__fish_seen_subcommand_from {}", here.empty() ? "" : "; and ", word);
    }
    if (!command.subcommands().empty()) {
      here += fmt::format("{}not __fish_seen_subcommand_from {}", here.empty() ? "" : "; and ",
                          subcommand_words(command));
    }
    for (const CLI::App* sub : command.subcommands()) {
      all += fmt::format("complete -c shearcell -f -n {} -a {} -d {}\n", shell_quoted(here),
                         sub->get_name(), shell_quoted(sub->get_description()));
    }
    for (const OptionEntry& option : command.options) {
      if (option.names.empty()) continue;  // a positional
      all += fmt::format("complete -c shearcell -n {}", shell_quoted(here));
      for (const std::string& name : option.names) {
        all += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      all += fmt::format("{} -d {}\n", option.placeholder.empty() ? "" : " -r",
                         shell_quoted(option.meaning));
    }
  }
  return all;
}

/// zsh runs the bash function.
std::string zsh(const std::vector<CommandEntry>& tree) {
  return "#compdef shearcell\nautoload -U +X bashcompinit && bashcompinit\n" + bash(tree);
}

}  // namespace

void add_completion(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand("completion", "Print a completion script for a shell");
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->footer(
      R"(Examples:
  shearcell completion bash > ~/.local/share/bash-completion/completions/shearcell
  source <(shearcell completion zsh)
  shearcell completion fish > ~/.config/fish/completions/shearcell.fish)");
  command->callback([shell, &app] {
    const std::vector<CommandEntry> tree = command_tree(app);
    fmt::print("{}", *shell == "bash" ? bash(tree) : *shell == "zsh" ? zsh(tree) : fish(tree));
  });
}

}  // namespace shearcell::cli
