// SPDX-License-Identifier: GPL-3.0-or-later
// `prune`: deletes files of checkpoints that can be recomputed, and keeps their records.
// `regenerate`: recomputes pruned and damaged files with the same bytes.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/figures/keep_measures.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/measure.hpp"
#include "experiments/runner/stage.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

struct PruneOptions {
  PruneChoice choice;
  RunSelection selection;
  bool yes = false;
};

/// Ids of the selected runs and of their packings.
std::set<std::string> selected_ids(const Store& store, RunSelection selection) {
  selection.packings = true;
  std::set<std::string> ids;
  for (const Run& run : select_runs(store, selection)) ids.insert(run.stage.id);
  return ids;
}

std::vector<CheckpointRecord> prunable(const PruneOptions& options, const Store& store) {
  PruneChoice choice = options.choice;
  const bool filtered = options.selection != RunSelection{};
  if (choice.runs.empty() && !filtered && choice.keep_every == 0 && !choice.last_too) {
    throw CLI::ValidationError(
        "prune",
        "choose which files to delete or keep: give runs, --experiment E, --state "
        "STATE, --keep-every K or --last-too; see prune --help");
  }
  for (std::string& run : choice.runs) run = store.find_stage(run).id;
  if (filtered) {
    const std::set<std::string> ids = selected_ids(store, options.selection);
    if (choice.runs.empty()) choice.runs.assign(ids.begin(), ids.end());
    std::erase_if(choice.runs, [&](const std::string& id) { return !ids.contains(id); });
    if (choice.runs.empty()) return {};  // Store::prunable() would choose all runs
  }
  return store.prunable(choice);
}

double bytes_of(const std::vector<CheckpointRecord>& records) {
  double bytes = 0;
  for (const CheckpointRecord& record : records) bytes += static_cast<double>(record.size);
  return bytes;
}

void print_plan(const Store& store, const std::vector<CheckpointRecord>& records) {
  std::map<std::string, std::vector<CheckpointRecord>> freed_by_run;
  for (const CheckpointRecord& record : records) freed_by_run[record.run].push_back(record);
  print_table(list_of(freed_by_run, [&](const auto& freed) -> Facts {
    const auto& [id, of_run] = freed;
    const Stage stage = store.stage(id);
    // All experiments that use the run, because all of them lose the files.
    std::set<std::string> experiments;
    for (const Membership& m : stage.memberships) experiments.insert(m.place.experiment);
    // Files that an earlier `prune` recorded as pruned but did not delete before it was killed.
    const auto left = std::ranges::count(of_run, CheckpointState::pruned, &CheckpointRecord::state);
    const std::size_t recorded = store.checkpoints(id).size() + static_cast<std::size_t>(left);
    return {{"", id.substr(0, 8), "run"},
            {"", fmt::format("{}", fmt::join(experiments, ", ")), "experiment"},
            {"", name_of(stage.state), "state"},
            {"", of_run.size(), "to free"},
            {"", recorded, "of"},
            {"", format_bytes(bytes_of(of_run)), "bytes"}};
  }));
}

bool agreed() {
  if (isatty(STDIN_FILENO) == 0) return false;
  print_stderr("Free them? [y/N] ");
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "Y");
}

void prune(const PruneOptions& options, Context& context) {
  Store store(context.store, Access::write);
  std::vector<CheckpointRecord> records = prunable(options, store);
  RunLineages known;
  const std::size_t kept = std::erase_if(
      records, [&](const CheckpointRecord& c) { return why_not_again(store, c, known); });
  if (!context.json && kept > 0) {
    fmt::print(
        "{} kept: not bitwise reproducible (computed by LAMMPS or with another bits_version)\n",
        counted(kept, "checkpoint"));
  }
  const std::size_t chosen = records.size();
  const std::vector<CheckpointRecord> leftovers = store.prune_leftovers();
  const auto with_leftovers = [&] {
    std::vector<CheckpointRecord> all = records;
    all.insert(all.end(), leftovers.begin(), leftovers.end());
    return all;
  };
  if (!context.json) {
    const std::vector<CheckpointRecord> all = with_leftovers();
    print_plan(store, all);
    fmt::print("{}, {}\n", counted(all.size(), "checkpoint"), format_bytes(bytes_of(all)));
  }
  const bool any = chosen + leftovers.size() > 0;
  const bool go = any && (options.yes || (!context.json && agreed()));
  Freed freed;
  if (go) {
    // The log will vouch for the cached measures, so some of them are computed again before.
    const MeasureCheck check =
        check_sample(store, store.folder(), records, kSampled, seed_of(store.head()));
    if (!check.findings.empty()) throw StoreDamaged(check.findings.front().message);
    const MeasureOptions measuring{
        .workers = usable_cores(),
        .report =
            terminal_counter("measuring checkpoints before their files are deleted: checkpoint")};
    freed = free_files(store, records, measuring, options.choice.last_too, context);
    freed.bytes += store.prune(leftovers);
  }
  if (context.json) {
    const auto checkpoint = [](const CheckpointRecord& record) -> nlohmann::json {
      return {{"run", record.run},
              {"cycle", record.cycle},
              {"sha256", record.sha256},
              {"size", record.size}};
    };
    const std::vector<CheckpointRecord> all = with_leftovers();
    print_json({{"checkpoints", list_of(all, checkpoint)},
                {"leftovers", leftovers.size()},
                {"kept_of_other_engines", kept},
                {"measured", freed.measured},
                {"kept_unmeasured", chosen - records.size()},
                {"bytes", bytes_of(all)},
                {"pruned", go},
                {"bytes_freed", freed.bytes}});
  } else if (freed.bytes > 0) {
    fmt::print("{} measured, then {} freed; `shearcell regenerate` recomputes the deleted files\n",
               counted(freed.measured, "checkpoint"), format_bytes(freed.bytes));
  } else if (any) {
    fmt::print("Nothing was freed.{}\n", go ? "" : " Use --yes to delete these files.");
  }
}

struct RegenerateOptions {
  std::vector<std::string> checkpoints;
  RunSelection selection;
  bool all = false;
  std::size_t threads = 1;
};

nlohmann::json regenerate_one(Store& store, const CheckpointRecord& record, std::size_t threads,
                              RunLineages& known, Context& context) {
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
  if (const auto why = why_not_again(store, record, known)) {
    fail(context, kOtherError);
    facts["why"] = *why;
    return say("refused", *why + "; restore the file from a copy");
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
                                     : std::string("the beginning of the stage"),
                         replay.steps));
}

std::vector<CheckpointRecord> named_checkpoints(const Store& store,
                                                const RegenerateOptions& options) {
  std::vector<CheckpointRecord> records;
  for (const std::string& prefix : options.checkpoints) {
    const auto found = store.find_checkpoint(prefix);
    if (!found) {
      throw NotFound(fmt::format(
          "the store has no checkpoint '{}'; `shearcell show RUN` lists the checkpoints of a run",
          prefix));
    }
    records.push_back(*found);
  }
  return records;
}

std::vector<CheckpointRecord> without_file(const Store& store, const RunSelection& selection) {
  std::vector<CheckpointRecord> records;
  for (const std::string& run : selected_ids(store, selection)) {
    for (CheckpointRecord& record : store.checkpoints(run, Listed::all)) {
      if (record.state == CheckpointState::recorded && store.load_if_readable(record)) continue;
      records.push_back(std::move(record));
    }
  }
  return records;
}

void regenerate(const RegenerateOptions& options, Context& context) {
  const bool named = !options.checkpoints.empty(), filtered = options.selection != RunSelection{};
  if (named == (options.all || filtered)) {
    throw CLI::ValidationError("regenerate",
                               "choose what to recompute: either name checkpoints, or select "
                               "runs with --experiment E or --all; see regenerate --help");
  }
  Store store(context.store, Access::write);
  std::vector<CheckpointRecord> records =
      named ? named_checkpoints(store, options) : without_file(store, options.selection);
  if (records.empty() && !context.json) fmt::print("every file is intact\n");
  // Parent stages and earlier steps come first: each state is recomputed from an earlier state.
  std::map<std::string, std::size_t> order;
  for (const Stage& stage : store.stages()) order.emplace(stage.id, order.size());
  std::ranges::sort(records, {}, [&](const auto& c) { return std::pair(order.at(c.run), c.step); });
  catch_stop_signals();
  nlohmann::json list = nlohmann::json::array();
  RunLineages known;
  DerivedCache measures(store.folder());
  MeasureSources sources(store);
  for (const CheckpointRecord& record : records) {
    if (stop_requested()) {
      fail(context, kInterrupted);
      break;
    }
    sources.read_run(record.run);
    const bool altered = !sources.compare_pruned(record, measures).altered.empty();
    list.push_back(regenerate_one(store, record, options.threads, known, context));
    if ((named || altered) && store.load_if_readable(record)) measures.forget(record.sha256);
  }
  if (context.json) print_json({{"checkpoints", list}});
}

}  // namespace

Freed free_files(Store& store, std::vector<CheckpointRecord>& records,
                 const MeasureOptions& options, bool last_too, Context& context) {
  const std::size_t chosen = records.size();
  const MeasureOutcome outcome = keep_measures(store, records, options);
  {
    static std::mutex printing;
    const std::lock_guard lock(printing);
    print_problems(outcome, "not measured", context);
    if (!outcome.cache_trouble.empty()) fail(context, kOtherError);
    if (records.size() < chosen) {
      print_stderr("kept, because measuring failed: the files of {}\n",
                   counted(chosen - records.size(), "checkpoint"));
    }
  }
  return {outcome.measured.size(), store.prune(records, last_too)};
}

void add_prune(CLI::App& app, Context& context) {
  const auto [command, options] = add_command(
      app, context, "prune",
      "Delete checkpoint files that can be recomputed; records and measures stay", prune);
  command->add_option("run", options->choice.runs,
                      "Only these runs: run ids, or unique beginnings of run ids");
  add_selection_options(*command, options->selection, true);
  add_number(*command, "--keep-every", options->choice.keep_every,
             "Keep the files of every K-th cycle", "K", 1, 1'000'000'000);
  command->add_flag("--last-too", options->choice.last_too,
                    "For completed stages, also delete the files of the newest checkpoint and of "
                    "checkpoints from which other stages start");
  command->add_flag("--yes,-y", options->yes, "Delete without asking");
  add_common_options(
      *command, context,
      R"(Choose files by runs, by options that select runs, or by --keep-every. The command lists the files
and asks before it deletes them. Without a terminal, nothing is deleted unless --yes is given.
The newest checkpoint of each run and the checkpoints that other stages start from are kept. With
--last-too, they are kept only for unfinished stages. If all stages are finished, only events and
measures remain. They are small enough to publish, and figures, tables and merges still work.
Checkpoints of LAMMPS, and of versions of this program that round differently, are never deleted,
because this program cannot recompute these checkpoints bit for bit.
Before a file is deleted, missing measures are computed: all measures that tables and plots need,
and the simulated measures that the store's figures need. The measures are cached in derived.sqlite,
so tables and figures do not change. A checkpoint that cannot be measured keeps its file. If a run
is continued later, its new cycles lack measures that need a pruned checkpoint, such as
msd_10_cycles_d2. `regenerate` recomputes pruned files; `run` and `resume` do so if they need them.
Examples:
  shearcell prune --keep-every 10
  shearcell prune --last-too
  shearcell prune --experiment drag --scale smoke --keep-every 10
  shearcell prune --state failed --yes)");
}

void add_regenerate(CLI::App& app, Context& context) {
  const auto [command, options] =
      add_command(app, context, "regenerate",
                  "Recompute the files of pruned or damaged checkpoints", regenerate);
  command->add_option("checkpoint", options->checkpoints,
                      "SHA-256 hashes of checkpoints, or beginnings of these hashes");
  add_selection_options(*command, options->selection, true);
  command->add_flag("--all", options->all, "Recompute all missing or damaged files of the store");
  add_threads_option(*command, options->threads, "Number of threads");
  add_common_options(
      *command, context,
      R"(Recomputes each state from the nearest earlier checkpoint that has a file. If there is no such
checkpoint in the stage, also recomputes the file of the initial state. If a state or a file does
not have the recorded hash, no file is written, ReplayDiverged is recorded, and the exit code is 4.
Also deletes the cached measures of checkpoints that are given by their hashes, and measures that do
not have the digests in the log. The next command that needs these measures computes them again.
Examples:
  shearcell regenerate 2a2c47ca
  shearcell regenerate --experiment drag --scale desk
  shearcell regenerate --all)");
}

}  // namespace shearcell::cli
