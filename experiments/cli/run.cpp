// SPDX-License-Identifier: GPL-3.0-or-later
// `run` and `resume`: compute unfinished runs. `resume --task` works as one task of a cluster job.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/cluster/submission.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/campaign.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/repeated.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
  std::vector<std::string> inputs;  ///< manifests for `run`, ids of runs for `resume`
  ExpandOptions expand;
  std::size_t jobs = 0;
  Parallel parallel;
  std::uint64_t keep_every = 0;
  bool quiet = false;
  bool leave_failed = false;
  bool task = false;    ///< whether this process is a task of a job that `submit` queued
  std::string scratch;  ///< value of --scratch; see unfit_scratch()
};

// A task reports its progress every kReportEvery. Every kSaveEvery, it copies its results from the
// node's own disk to the store of the task. If a node fails, work after the last copy is lost.
constexpr std::chrono::seconds kReportEvery{10};
constexpr std::chrono::seconds kSaveEvery{300};

void require_lammps_for_ranks(const RunOptions& options, bool lammps) {
  if (options.parallel.ranks == 1 || lammps) return;
  throw CLI::ValidationError("--mpi", "has no effect, because no run uses LAMMPS. Omit --mpi");
}

// Number of runs to compute at a time. By default, all cores are used.
std::size_t workers(const RunOptions& options) {
  if (options.jobs > 0) return options.jobs;
  const std::size_t each = std::max(options.parallel.threads, options.parallel.ranks);
  return std::max<std::size_t>(1, usable_cores() / each);
}

CampaignResult compute(Store& store, const std::vector<StageJob>& jobs, const RunOptions& options,
                       Context& context) {
  if (!options.task) catch_stop_signals();
  std::atomic<std::size_t> deleted = 0;
  const auto prune = [&](const std::string& stage) {  // called when the stage is done
    std::vector<CheckpointRecord> records = store.prunable({{stage}, options.keep_every});
    RunLineages known;
    std::erase_if(records, [&](const auto& c) { return why_not_again(store, c, known); });
    if (records.empty()) return;
    free_files(store, records, {}, false, context);
    deleted += records.size();
  };
  CampaignResult result =
      run_campaign(store, jobs, workers(options), options.parallel, options.quiet,
                   options.keep_every > 0 ? prune : std::function<void(const std::string&)>());
  result.files_deleted = deleted;
  return result;
}

// Prints the result and sets the exit code.
void print_result(const CampaignResult& result, Context& context) {
  const bool interrupted = result.interrupted > 0 || (stop_requested() && result.blocked > 0);
  fail(context, result.damaged > 0   ? kStoreDamaged
                : result.failed > 0  ? kRunFailed
                : interrupted        ? kInterrupted
                : result.blocked > 0 ? kOtherError
                : result.left_failed ? kRunFailed
                                     : kDone);
  if (context.json) {
    print_json({{"completed", result.completed},
                {"already_done", result.already},
                {"done_elsewhere", result.elsewhere},
                {"failed", result.failed},
                {"interrupted", result.interrupted},
                {"not_begun", result.blocked},
                {"damaged", result.damaged},
                {"files_deleted", result.files_deleted},
                {"messages", result.messages},
                {"warnings", context.warnings}});
  } else if (result == CampaignResult{.left_failed = result.left_failed}) {
    fmt::print("nothing is left to compute\n");
  } else {
    fmt::print("{} computed, {} done already, {} failed, {} interrupted, {} not started\n",
               counted(result.completed, "stage"), result.already, result.failed,
               result.interrupted, result.blocked);
    for (const auto& [number, one, what] :
         {std::tuple(result.elsewhere, "stage", "computed by other processes in the meantime"),
          {result.files_deleted, "file", "deleted by --keep-every"},
          {result.damaged, "stage", "stopped by damaged files in the store"}}) {
      if (number > 0) fmt::print("{} {}\n", counted(number, one), what);
    }
  }
  if (interrupted) {
    print_stderr("Interrupted. Continue with: shearcell resume --store {}\n",
                 shell_word(context.store));
  }
}

void run(const RunOptions& options, Context& context) {
  // All manifests are read and checked before anything is written.
  const std::vector<Plan> plans = load_plans(options.inputs, options.expand, context);
  const bool lammps = std::ranges::any_of(plans, asks_for_lammps);
  require_lammps_for_ranks(options, lammps);
  if (lammps) find_lammps(options.parallel.ranks);  // throws if it is not installed
  Store store(context.store, Access::create);
  std::vector<StageJob> jobs;
  std::set<std::string> known;
  for (const Plan& plan : plans) {
    if (!plan.read.empty() && !context.json) fmt::print("{}\n", plan.read);
    for (StageJob& job : declare(store, plan)) {
      if (known.insert(job.id).second) jobs.push_back(std::move(job));
    }
  }
  print_result(compute(store, jobs, options, context), context);
}

// Removes jobs of failed stages and jobs that depend on them. Returns whether a job was removed.
bool leave_failed(Store& store, std::vector<StageJob>& jobs) {
  std::set<std::string> left;
  std::erase_if(jobs, [&](const StageJob& job) {  // parents come first
    const bool leave = left.contains(job.parent) || store.stage(job.id).state == StageState::failed;
    if (leave) left.insert(job.id);
    return leave;
  });
  return !left.empty();
}

CampaignResult compute_rest(Store& store, const RunOptions& options, Context& context) {
  std::vector<StageJob> jobs = stages_to_resume(store, options.inputs);
  const bool left_failed = options.leave_failed && leave_failed(store, jobs);
  const auto by_lammps = [&](const StageJob& job) {
    return engine_of(store.stage(job.id).resolved) == EngineKind::lammps;
  };
  require_lammps_for_ranks(options, jobs.empty() || std::ranges::any_of(jobs, by_lammps));
  CampaignResult result = compute(store, jobs, options, context);
  result.left_failed = left_failed;
  return result;
}

// Returns the folder in which the task computes: its store, or if `scratch` is set, a copy on the
// node's disk. The name of the copy contains the ids of the submission and the task, so that a
// restarted task finds the copy.
fs::path working_folder(const fs::path& task, const std::string& scratch) {
  if (scratch.empty()) return task;
  const Store sound(task, Access::write);  // throws before copying if the store is unusable
  const fs::path whole = fs::absolute(task);
  const fs::path copy = scratch_here(scratch) / fmt::format("shearcell-{}-{}",
                                                            whole.parent_path().filename().string(),
                                                            whole.filename().string());
  Store store(copy, Access::create);
  merge_stores(store, {task});
  return copy;
}

void resume_task(const RunOptions& options, Context& context) {
  catch_batch_signals();
  // No slash at the end, since names of files beside the folder are derived from this path.
  const fs::path task = (fs::path(context.store) / "").parent_path();
  const fs::path folder = working_folder(task, options.scratch);
  const bool is_copy = folder != task;
  std::optional<Store> store(std::in_place, folder, Access::write);
  std::set<std::string> runs;  // ids of the task's runs; only these runs are copied back
  for (const Stage& stage : store->stages()) runs.insert(stage.id);
  const auto report = [&] { write_task_report(task, store->stages()); };
  const auto save = [&] {
    Store own(task, Access::write);
    merge_stores(own, {folder}, runs);
  };
  const auto complain = [](const std::exception& problem) {
    print_stderr("shearcell: {}; will try again\n", problem.what());
  };
  CampaignResult result;
  {
    report();
    const Repeated reports(kReportEvery, report, complain);
    std::optional<Repeated> saves;
    if (is_copy) saves.emplace(kSaveEvery, save, complain);
    result = compute_rest(*store, options, context);
  }
  report();
  if (is_copy) {
    save();
    store.reset();
    fs::remove_all(folder);
  }
  print_result(result, context);
  // A task that was stopped before its end is restarted later, even if some runs have failed.
  if (stop_requested() && result.interrupted + result.blocked > 0) {
    context.exit_code = kInterrupted;
  }
}

void resume_runs(const RunOptions& options, Context& context) {
  if (options.task) return resume_task(options, context);
  Store store(context.store, Access::write);
  print_result(compute_rest(store, options, context), context);
}

void add_worker_options(CLI::App& command, RunOptions& options) {
  add_number(command, "--jobs,-j", options.jobs,
             "Number of runs computed at a time (default: one per core)", "J", 1, 1024);
  add_threads_option(command, options.parallel.threads, "Threads inside each run");
  add_number(command, "--mpi", options.parallel.ranks,
             "MPI processes of each LAMMPS run; this number affects the last digits of results",
             "N", 1, 65536);
  add_number(
      command, "--keep-every", options.keep_every,
      "When a run is completed, measure its checkpoints and delete their files as `prune` does, "
      "but keep the files of every K-th cycle",
      "K", 1, 1'000'000'000);
  command.add_flag("--quiet,-q", options.quiet, "Show no progress");
}

}  // namespace

void add_run(CLI::App& app, Context& context) {
  const auto [command, options] =
      add_command(app, context, "run", "Compute the runs of manifests", run);
  add_manifest_options(*command, options->inputs, options->expand, true);
  add_worker_options(*command, *options);
  add_common_options(*command, context, R"(Examples:
  shearcell run experiments/drag.yaml --scale smoke
  shearcell run experiments/drag.yaml --scale desk --cycles 100   # extend
  shearcell run experiments/critical_size.yaml --scale paper --variant amplitude_rad=0.1
  shearcell run experiments/drag.yaml --scale desk --seed 4-6     # the seeds for this machine
  shearcell run experiments/drag.yaml --scale smoke --engine lammps --mpi 2

Computes only what the store does not contain. Ctrl-C writes checkpoints and ends the program with
code 85. `run` or `resume` then continues the runs bit for bit. A second Ctrl-C kills the program
(code 130), and only the work since the last checkpoints is lost. Several programs on one machine
can share the work on one store. To use several machines, select different runs on each machine with
--variant or --seed, and merge the stores.)");

  const auto [resume, resume_options] =
      add_command(app, context, "resume", "Continue unfinished runs", resume_runs);
  resume->add_option("run", resume_options->inputs,
                     "Run ids, or unique beginnings of run ids (default: all runs)");
  add_worker_options(*resume, *resume_options);
  resume->add_flag("--leave-failed", resume_options->leave_failed, "Do not try failed runs again");
  CLI::Option* task =
      resume->add_flag("--task", resume_options->task,
                       "Work as a task of a job that `submit` queued; --store is the task's store");
  resume
      ->add_option("--scratch", resume_options->scratch,
                   "Copy the store to this folder on the node's own disk and work on the copy. DIR "
                   "may contain environment variables of the node, as $NAME or ${NAME}")
      ->needs(task)
      ->type_name("DIR");
  add_common_options(
      *resume, context,
      R"(A task reports its progress to `status`. On SIGTERM or SIGUSR1, a task writes checkpoints and ends
with code 85. If it is started again, it continues the runs bit for bit. With --scratch, a task
copies its results back to its store every five minutes and at the end.
Examples:
  shearcell resume
  shearcell resume 3f9a)");
}

}  // namespace shearcell::cli
