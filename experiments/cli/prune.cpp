// SPDX-License-Identifier: GPL-3.0-or-later
// `prune`: deletes files of checkpoints that can be recomputed; their records stay.
// `regenerate`: recomputes such files, and damaged ones, with the same bytes.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "experiments/cli/command.hpp"
#include "experiments/runner/replay.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/errors.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

struct PruneOptions {
  PruneChoice choice;
  std::string state;
  bool yes = false;
};

PruneChoice choice_of(const PruneOptions& options, const Store& store) {
  PruneChoice choice = options.choice;
  if (choice.runs.empty() && options.state.empty() && choice.keep_every == 0) {
    throw CLI::ValidationError(
        "prune", "choose what to delete: --keep-every K, --state STATE, or runs; see prune --help");
  }
  for (std::string& run : choice.runs) run = store.find_run(run).id;
  choice.state = value_of<RunState>(options.state);
  return choice;
}

double bytes_of(const std::vector<CheckpointRecord>& records) {
  double bytes = 0;
  for (const CheckpointRecord& record : records) bytes += static_cast<double>(record.size);
  return bytes;
}

void print_plan(const Store& store, const std::vector<CheckpointRecord>& records) {
  std::map<std::string, std::vector<CheckpointRecord>> by_run;
  for (const CheckpointRecord& record : records) by_run[record.run].push_back(record);
  print_table({"run", "state", "to free", "of", "bytes"}, by_run, [&](const auto& freed) -> Row {
    const auto& [id, of_run] = freed;
    return {id.substr(0, 8), std::string(name_of(store.run(id).state)),
            std::to_string(of_run.size()), std::to_string(store.checkpoints(id).size()),
            format_bytes(bytes_of(of_run))};
  });
}

bool agreed() {
  if (isatty(STDIN_FILENO) == 0) return false;
  print_stderr("Free them? [y/N] ");
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "Y");
}

void prune(const PruneOptions& options, Context& context) {
  Store store(context.store, Access::write);
  std::vector<CheckpointRecord> records = store.prunable(choice_of(options, store));
  const std::size_t kept = std::erase_if(
      records, [&](const CheckpointRecord& c) { return why_not_again(store.run(c.run)); });
  if (!context.json && kept > 0) {
    fmt::print("{} checkpoints of LAMMPS are kept: they cannot be recomputed\n", kept);
  }
  const std::size_t news = records.size();
  for (CheckpointRecord& left : store.prune_leftovers()) records.push_back(std::move(left));
  if (!context.json) {
    print_plan(store, records);
    fmt::print("{}, {}\n", counted(records.size(), "checkpoint"), format_bytes(bytes_of(records)));
  }
  const bool go = !records.empty() && (options.yes || (!context.json && agreed()));
  const std::uint64_t freed = go ? store.prune(records) : 0;
  if (context.json) {
    const auto checkpoint = [](const CheckpointRecord& record) -> nlohmann::json {
      return {{"run", record.run},
              {"cycle", record.cycle},
              {"sha256", record.sha256},
              {"size", record.size}};
    };
    print_json({{"checkpoints", json_list(records, checkpoint)},
                {"leftovers", records.size() - news},
                {"kept_of_other_engines", kept},
                {"bytes", bytes_of(records)},
                {"pruned", go},
                {"bytes_freed", freed}});
  } else if (go) {
    fmt::print("{} freed; `shearcell regenerate CHECKPOINT` recomputes a file\n",
               format_bytes(static_cast<double>(freed)));
  } else if (!records.empty()) {
    fmt::print("Nothing was freed. Use --yes to delete these files.\n");
  }
}

struct RegenerateOptions {
  std::vector<std::string> checkpoints;
  std::size_t threads = 1;
};

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
      print_text("{:.12} (run {:.8}, cycle {:g}): {}\n", record.sha256, record.run, record.cycle,
                 text);
    }
    return facts;
  };
  if (record.state == CheckpointState::recorded && store.load_if_readable(record)) {
    return say("kept", "the file is intact");
  }
  if (const auto why = why_not_again(store.run(record.run))) {
    fail(context, kOtherError);
    facts["why"] = *why;
    return say("refused", *why + "; keep a copy of its file elsewhere");
  }
  const Replay replay = regenerate_checkpoint(store, record, threads);
  facts["steps"] = replay.steps;
  if (replay.interrupted) {
    fail(context, kInterrupted);
    return say("interrupted", "interrupted; nothing was changed");
  }
  if (replay.divergence) {
    fail(context, kStoreDamaged);
    facts["why"] = replay.divergence->message;
    return say("diverged", "DIVERGED: " + replay.divergence->message);
  }
  return say("regenerated",
             fmt::format("recomputed from {} ({} steps): the same state, the same bytes",
                         replay.from ? fmt::format("cycle {:g}", replay.from->cycle)
                                     : std::string("the beginning of its stage"),
                         replay.steps));
}

void regenerate(const RegenerateOptions& options, Context& context) {
  Store store(context.store, Access::write);
  std::vector<CheckpointRecord> records;
  for (const std::string& prefix : options.checkpoints) {
    const auto found = store.find_checkpoint(prefix);
    if (!found) {
      throw NotFound(fmt::format(
          "the store has no checkpoint '{}'; `shearcell show RUN` lists those of a run", prefix));
    }
    records.push_back(*found);
  }
  // In order of steps, so that each checkpoint of a run can start from the one before it.
  std::ranges::sort(records, {}, [](const auto& c) { return std::tie(c.run, c.step); });
  catch_stop_signals();
  nlohmann::json list = nlohmann::json::array();
  for (const CheckpointRecord& record : records) {
    if (stop_requested()) {
      fail(context, kInterrupted);
      break;
    }
    list.push_back(regenerate_one(store, record, options.threads, context));
  }
  if (context.json) print_json({{"checkpoints", list}});
}

}  // namespace

void add_prune(CLI::App& app, Context& context) {
  auto options = std::make_shared<PruneOptions>();
  CLI::App* command = app.add_subcommand(
      "prune", "Delete checkpoint files that can be recomputed; their records stay");
  command->add_option("run", options->choice.runs,
                      "Only these runs: ids, or unique beginnings of them");
  command->add_option("--state", options->state, "Only runs in this state")
      ->check(one_of<RunState>());
  add_number(*command, "--keep-every", options->choice.keep_every, "Keep every K-th cycle", "K", 1,
             1'000'000'000);
  command->add_flag("--yes,-y", options->yes, "Delete without asking");
  add_common_options(*command, context);
  command->footer(
      "Name runs, or give --state or --keep-every. Lists the files and asks; without a terminal "
      "it\n"
      "deletes nothing unless --yes is given. Never deletes the newest checkpoint of a run, those\n"
      "that other stages started from, or those of LAMMPS. Records stay, and `regenerate`\n"
      "recomputes a file.\n"
      "Examples:\n  shearcell prune --keep-every 10\n  shearcell prune --state failed --yes");
  command->callback([options, &context] { prune(*options, context); });
}

void add_regenerate(CLI::App& app, Context& context) {
  auto options = std::make_shared<RegenerateOptions>();
  CLI::App* command =
      app.add_subcommand("regenerate", "Recompute the files of pruned or damaged checkpoints");
  command
      ->add_option("checkpoint", options->checkpoints,
                   "SHA-256 of checkpoints, or beginnings of them")
      ->required();
  add_threads_option(*command, options->threads, "Threads, for large cells");
  add_common_options(*command, context);
  command->footer(
      R"(Steps from the nearest earlier checkpoint. If the state or the file does not have the recorded
hash, writes nothing, records ReplayDiverged and ends with code 4.
Examples:
  shearcell regenerate 2a2c47ca)");
  command->callback([options, &context] { regenerate(*options, context); });
}

}  // namespace shearcell::cli
