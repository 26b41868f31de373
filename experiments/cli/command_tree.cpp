// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/command_tree.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace shearcell::cli {
namespace {

constexpr std::size_t kLongestChoice = 60;

OptionEntry entry(const CLI::Option& option) {
  OptionEntry made;
  for (const std::string& name : option.get_snames()) made.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) made.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) {
    made.placeholder = option.get_positional() ? option.get_single_name() : option.get_type_name();
    if (const auto choices = made.placeholder.find(":{"); choices != std::string::npos) {
      std::string one_of = made.placeholder.substr(choices + 2);
      one_of.pop_back();
      std::ranges::replace(one_of, ',', '|');
      made.placeholder.erase(choices);
      if (one_of.size() <= kLongestChoice) made.placeholder = one_of;  // longer lists are left out
    }
    if (made.placeholder.empty()) made.placeholder = "VALUE";
  }
  made.meaning = option.get_description();
  if (const std::string value = option.get_default_str(); !value.empty()) {
    made.meaning += fmt::format(" (default: {})", value);
  }
  return made;
}

}  // namespace

std::vector<CommandEntry> command_tree(const CLI::App& app, std::vector<std::string> path) {
  CommandEntry made{path, &app, {}};
  for (const CLI::Option* option : app.get_options()) made.options.push_back(entry(*option));
  const auto is_positional = [](const OptionEntry& option) { return option.names.empty(); };
  std::stable_partition(made.options.begin(), made.options.end(), is_positional);
  std::vector<CommandEntry> tree = {made};
  path.emplace_back();
  for (const CLI::App* sub : made.subcommands()) {
    path.back() = sub->get_name();
    std::ranges::move(command_tree(*sub, path), std::back_inserter(tree));
  }
  return tree;
}

std::string spoken(const CommandEntry& command) {
  return fmt::format("shearcell {}", fmt::join(command.path, " "));
}

}  // namespace shearcell::cli
