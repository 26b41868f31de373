// SPDX-License-Identifier: GPL-3.0-or-later
// The parser's commands and options as data, for texts generated from them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace shearcell::cli {

struct OptionEntry {
  std::vector<std::string> names;  ///< "-j", "--jobs"; empty for a positional
  std::string placeholder;         ///< name of its value, as J; empty for a flag
  std::string meaning;
};

struct CommandEntry {
  std::vector<std::string> path;  ///< {} for the program, {"bench", "speed"}
  const CLI::App* app;
  std::vector<OptionEntry> options;  ///< positionals first
  std::vector<const CLI::App*> subcommands() const { return app->get_subcommands({}); }
};

/// The command, then each of its subcommands followed by their own, in the order of their
/// declaration.
std::vector<CommandEntry> command_tree(const CLI::App& app, std::vector<std::string> path = {});

/// "shearcell bench speed".
std::string spoken(const CommandEntry& command);

}  // namespace shearcell::cli
