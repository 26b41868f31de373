// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/command_tree.hpp"

namespace shearcell::cli {
namespace {

OptionEntry entry(const CLI::Option& option) {
  OptionEntry made;
  for (const std::string& name : option.get_snames()) made.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) made.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) {
    made.placeholder = option.get_positional() ? option.get_single_name() : option.get_type_name();
    const auto colon = made.placeholder.find(':');
    if (colon != std::string::npos) made.placeholder.erase(colon);
    if (made.placeholder.empty()) made.placeholder = "VALUE";
  }
  made.meaning = option.get_description();
  return made;
}

void append(const CLI::App& app, const std::vector<std::string>& path,
            std::vector<CommandEntry>& tree) {
  CommandEntry made{path, app.get_description(), app.get_footer(), {}, {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    (option->get_positional() ? made.positionals : made.options).push_back(entry(*option));
  }
  const std::vector<const CLI::App*> below =
      app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });
  for (const CLI::App* sub : below) made.subcommands.push_back(sub->get_name());
  tree.push_back(made);
  for (const CLI::App* sub : below) {
    std::vector<std::string> deeper = path;
    deeper.push_back(sub->get_name());
    append(*sub, deeper, tree);
  }
}

}  // namespace

std::vector<CommandEntry> command_tree(const CLI::App& app) {
  std::vector<CommandEntry> tree;
  append(app, {}, tree);
  return tree;
}

std::string spoken(const CommandEntry& command) {
  std::string words = "shearcell";
  for (const std::string& word : command.path) words += " " + word;
  return words;
}

}  // namespace shearcell::cli
