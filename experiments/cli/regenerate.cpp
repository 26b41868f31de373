// SPDX-License-Identifier: GPL-3.0-or-later
// `regenerate`: recomputes files of pruned or damaged checkpoints with the same bytes.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "experiments/cli/command.hpp"
#include "experiments/runner/replay.hpp"
#include "experiments/runner/stop.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/errors.hpp"

namespace shearcell::cli {
namespace {

struct RegenerateWish {
  std::vector<std::string> checkpoints;
  std::size_t threads = 1;
};

bool sound(const Store& store, const CheckpointRecord& record) {
  try {
    store.load_checkpoint(record);
    return record.state == CheckpointState::recorded;
  } catch (const CheckpointPruned&) {
    return false;
  } catch (const StoreDamaged&) {
    return false;
  }
}

nlohmann::json regenerate_one(Store& store, const CheckpointRecord& record, std::size_t threads,
                              Context& context) {
  nlohmann::json facts = {{"sha256", record.sha256},
                          {"run", record.run},
                          {"cycle", record.cycle},
                          {"file", record.file},
                          {"steps", 0}};
  const auto say = [&](const std::string& outcome, const std::string& text) {
    facts["outcome"] = outcome;
    if (!context.json) {
      tell("{:.12} (run {:.8}, cycle {:g}): {}\n", record.sha256, record.run, record.cycle, text);
    }
    return facts;
  };
  if (sound(store, record)) return say("kept", "the file is intact");
  if (const auto why = why_not_again(store.run(record.run))) {
    context.exit_code = kOtherError;
    facts["why"] = *why;
    return say("refused", *why + "; keep a copy of its file elsewhere");
  }
  const Replay replay = regenerate_checkpoint(store, record, threads);
  facts["steps"] = replay.steps;
  if (replay.interrupted) {
    context.exit_code = kInterrupted;
    return say("interrupted", "interrupted; nothing was changed");
  }
  if (replay.divergence) {
    context.exit_code = kStoreDamaged;
    facts["why"] = replay.divergence->message;
    return say("diverged", "DIVERGED: " + replay.divergence->message);
  }
  return say("regenerated",
             fmt::format("the same state and the same file again, from {} ({} steps)",
                         replay.from ? fmt::format("cycle {:g}", replay.from->cycle)
                                     : std::string("the beginning of its stage"),
                         replay.steps));
}

void regenerate(const RegenerateWish& wish, Context& context) {
  Store store(context.store, Access::write);
  std::vector<CheckpointRecord> records;
  for (const std::string& prefix : wish.checkpoints) {
    records.push_back(store.find_checkpoint(prefix));
  }
  // Each from the one before it, where several of a run are asked for.
  std::sort(records.begin(), records.end(), [](const auto& a, const auto& b) {
    return std::tie(a.run, a.step) < std::tie(b.run, b.step);
  });
  catch_stop_signals();
  nlohmann::json list = nlohmann::json::array();
  for (const CheckpointRecord& record : records) {
    list.push_back(regenerate_one(store, record, wish.threads, context));
    if (stop_requested()) break;
  }
  if (context.json) print_json({{"checkpoints", list}});
}

}  // namespace

void add_regenerate(CLI::App& app, Context& context) {
  auto wish = std::make_shared<RegenerateWish>();
  CLI::App* command =
      app.add_subcommand("regenerate", "Recompute the files of pruned or damaged checkpoints");
  command
      ->add_option("checkpoint", wish->checkpoints, "SHA-256 of checkpoints, or beginnings of them")
      ->required();
  add_threads_option(*command, wish->threads, "Threads, for large cells");
  add_common_options(*command, context, true);
  command->footer(
      "Steps from the nearest earlier checkpoint. If the state or the file does not have the "
      "recorded\n"
      "hash, writes nothing, records ReplayDiverged and ends with code 4.\n"
      "Examples:\n  shearcell regenerate 2a2c47ca");
  command->callback([wish, &context] { regenerate(*wish, context); });
}

}  // namespace shearcell::cli
