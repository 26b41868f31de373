// SPDX-License-Identifier: GPL-3.0-or-later
// `log`: lists the events of the whole store or of one run, oldest first.
#include <fmt/format.h>

#include <utility>

#include "experiments/cli/command.hpp"
#include "provenance/json_text.hpp"

namespace shearcell::cli {
namespace {

std::string gist(const nlohmann::json& body) {
  for (const char* key : {"why", "error", "cycle", "attempt", "experiment", "path", "kind"}) {
    if (body.contains(key)) return fmt::format("{} {:.60}", key, short_text(body[key]));
  }
  return "";
}

/// Returns the name of the stream. An id in the name is shortened to eight digits.
std::string shown_stream(const std::string& stream) {
  const bool has_id = stream.starts_with("run/") || stream.starts_with("manifest/");
  return has_id ? stream.substr(0, stream.find('/') + 9) : stream;
}

void print_log(const std::string& run, Context& context) {
  const Store store(context.store, Access::read);
  const std::string stream = run.empty() ? "" : run_stream(store.find_stage(run).id);
  const auto facts = [](const Event& event) -> Facts {
    nlohmann::json body = event.body();
    std::string most_useful = gist(body);
    return {{"seq", event.seq, "seq"},
            {"recorded_at", event.recorded_at, "UTC", event.recorded_at.substr(0, 19)},
            {"stream", event.stream, "stream", shown_stream(event.stream)},
            {"version", event.version},
            {"type", event.type, "event"},
            {"payload", std::move(body), "", std::move(most_useful)},
            {"hash", event.hash}};
  };
  print_list("events", list_of(store.events(stream), facts), context);
}

}  // namespace

void add_log(CLI::App& app, Context& context) {
  const auto [command, run] =
      add_command(app, context, "log", "List the events of the store or of one run", print_log);
  command->add_option("run", *run, "Run id, or a unique beginning of a run id");
  add_common_options(*command, context, "Examples:\n  shearcell log\n  shearcell log 3f9a --json");
}

}  // namespace shearcell::cli
