// SPDX-License-Identifier: GPL-3.0-or-later
// `rebuild`: derives every table from the events again.
#include <fmt/format.h>

#include "experiments/cli/command.hpp"

namespace shearcell::cli {
namespace {

void rebuild(Context& context) {
  Store store(context.store, Access::write);
  store.rebuild();
  const std::vector<RunRecord> runs = store.runs();
  const Head head = store.head();
  if (context.json) {
    print_json({{"events", head.seq}, {"runs", runs.size()}});
  } else {
    fmt::print("{} runs derived from {} events\n", runs.size(), head.seq);
  }
}

}  // namespace

void add_rebuild(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("rebuild", "Derive every table of the store from its events again");
  add_common_options(*command, context, true);
  command->footer(
      "For a store of which `verify` says that a table is not what the events give. The events "
      "and\n"
      "the checkpoints stay as they are.\n"
      "Examples:\n  shearcell rebuild");
  command->callback([&context] { rebuild(context); });
}

}  // namespace shearcell::cli
