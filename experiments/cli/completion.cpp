// SPDX-License-Identifier: GPL-3.0-or-later
// `completion`: scripts with which a shell completes commands, options and paths.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "experiments/cli/command.hpp"
#include "experiments/cli/command_tree.hpp"
#include "provenance/io/child_process.hpp"

namespace shearcell::cli {
namespace {

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string option_words(const CommandEntry& command) {
  std::vector<std::string> names;
  for (const OptionEntry& option : command.options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return joined(names);
}

std::string bash(const std::vector<CommandEntry>& tree) {
  std::string cases;
  for (const CommandEntry& command : tree) {
    cases +=
        fmt::format("    {}) commands={}; options={} ;;\n", shell_quoted(joined(command.path)),
                    shell_quoted(joined(command.subcommands)), shell_quoted(option_words(command)));
  }
  return fmt::format(
      "# bash completion for shearcell: source it, or put it where bash-completion looks.\n"
      "_shearcell() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} path='' commands='' options='' word\n"
      "  _shearcell_words ''\n"
      "  for word in \"${{COMP_WORDS[@]:1:$((COMP_CWORD - 1))}}\"; do\n"
      "    case \" $commands \" in *\" $word \"*)\n"
      "      path=${{path:+$path }}$word; _shearcell_words \"$path\" ;;\n"
      "    esac\n"
      "  done\n"
      "  if [[ $current == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
      "  elif [[ -n $commands ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$commands\" -- \"$current\"))\n"
      "  else\n"
      "    local IFS=$'\\n'\n      COMPREPLY=($(compgen -f -- \"$current\"))\n"
      "  fi\n"
      "}}\n"
      "_shearcell_words() {{\n"
      "  case $1 in\n{}"
      "  esac\n"
      "}}\n"
      "complete -o filenames -F _shearcell shearcell\n",
      cases);
}

std::string fish(const std::vector<CommandEntry>& tree) {
  std::string all = "# fish completion for shearcell\n";
  for (const CommandEntry& command : tree) {
    std::string here;  // the condition that this command has been typed, and none of those below it
    for (const std::string& word : command.path) {
      here += fmt::format("{}__fish_seen_subcommand_from {}", here.empty() ? "" : "; and ", word);
    }
    if (!command.subcommands.empty()) {
      here += fmt::format("{}not __fish_seen_subcommand_from {}", here.empty() ? "" : "; and ",
                          joined(command.subcommands));
    }
    for (const CommandEntry& sub : tree) {
      if (sub.path.size() != command.path.size() + 1 ||
          !std::equal(command.path.begin(), command.path.end(), sub.path.begin())) {
        continue;
      }
      all += fmt::format("complete -c shearcell -f -n {} -a {} -d {}\n", shell_quoted(here),
                         sub.path.back(), shell_quoted(sub.meaning));
    }
    for (const OptionEntry& option : command.options) {
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

/// zsh runs the function written for bash.
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
      "Examples:\n"
      "  shearcell completion bash > ~/.local/share/bash-completion/completions/shearcell\n"
      "  source <(shearcell completion zsh)\n"
      "  shearcell completion fish > ~/.config/fish/completions/shearcell.fish");
  command->callback([shell, &app] {
    const std::vector<CommandEntry> tree = command_tree(app);
    fmt::print("{}", *shell == "bash" ? bash(tree) : *shell == "zsh" ? zsh(tree) : fish(tree));
  });
}

}  // namespace shearcell::cli
