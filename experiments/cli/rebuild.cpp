// SPDX-License-Identifier: GPL-3.0-or-later
// `rebuild`: rebuilds every table from the events.
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
      app.add_subcommand("rebuild", "Rebuild the tables of the store from its events");
  add_common_options(*command, context, true);
  command->footer(
      "Use it when `verify` reports a table that differs from the events. Events and checkpoints "
      "do\n"
      "not change.\n"
      "Examples:\n  shearcell rebuild");
  command->callback([&context] { rebuild(context); });
}

}  // namespace shearcell::cli
