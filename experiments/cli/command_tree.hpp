// SPDX-License-Identifier: GPL-3.0-or-later
// The commands and options of the program as data, read from the parser, so that completion,
// manual page and reference always match it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace shearcell::cli {

struct OptionEntry {
  std::vector<std::string> names;  ///< "-j", "--jobs"; none for a positional
  std::string placeholder;         ///< what stands for its value; empty for a flag
  std::string meaning;
};

struct CommandEntry {
  std::vector<std::string> path;  ///< below the program: {} for itself, {"bench", "speed"}
  std::string meaning;
  std::string footer;
  std::vector<OptionEntry> options;
  std::vector<OptionEntry> positionals;
  std::vector<std::string> subcommands;
};

/// The program first, then its subcommands in the order in which they were added, each before its
/// own. Groups named "" are hidden and left out.
std::vector<CommandEntry> command_tree(const CLI::App& app);

/// "shearcell bench speed".
std::string spoken(const CommandEntry& command);

}  // namespace shearcell::cli
