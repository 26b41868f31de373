// SPDX-License-Identifier: GPL-3.0-or-later
// `log`: the events, of the whole store or of one run, oldest first.
#include <fmt/format.h>

#include <memory>

#include "experiments/cli/command.hpp"
#include "provenance/json_text.hpp"

namespace shearcell::cli {
namespace {

// The most useful fact of an event.
std::string gist(const Event& event) {
  const nlohmann::json body = event.body();
  for (const char* key : {"why", "error", "cycle", "attempt", "experiment", "path", "kind"}) {
    if (body.contains(key)) return fmt::format("{} {:.60}", key, short_text(body[key]));
  }
  return "";
}

void print_log(const std::string& run, Context& context) {
  const Store store(context.store, Access::read);
  const std::string stream = run.empty() ? "" : run_stream(store.find_run(run).id);
  const std::vector<Event> events = store.events(stream);
  if (context.json) {
    const auto facts = [](const Event& event) -> nlohmann::json {
      return {{"seq", event.seq},   {"stream", event.stream},           {"version", event.version},
              {"type", event.type}, {"recorded_at", event.recorded_at}, {"payload", event.body()},
              {"hash", event.hash}};
    };
    return print_json({{"events", json_list(events, facts)}});
  }
  print_table({"seq", "UTC", "stream", "event", ""}, events, [](const Event& event) -> Row {
    const auto slash = event.stream.find('/');
    return {std::to_string(event.seq), event.recorded_at.substr(0, 19),
            event.stream.substr(0, slash + 9), event.type, gist(event)};
  });
}

}  // namespace

void add_log(CLI::App& app, Context& context) {
  auto run = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("log", "List the events of the store or of one run");
  command->add_option("run", *run, "Run id, or a unique beginning of it");
  add_common_options(*command, context);
  command->footer("Examples:\n  shearcell log\n  shearcell log 3f9a --json");
  command->callback([run, &context] { print_log(*run, context); });
}

}  // namespace shearcell::cli
