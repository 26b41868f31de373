// SPDX-License-Identifier: GPL-3.0-or-later
// `work`: one task of an array job, on the store that `submit` made for it.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "experiments/cli/command.hpp"
#include "experiments/cluster/submission.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/repeated.hpp"
#include "experiments/runner/stop.hpp"

namespace shearcell::cli {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

struct WorkOptions {
  std::size_t jobs = 1;
  std::size_t threads = 1;
  std::string scratch;
  bool leave_failed = false;
};

// Intervals of the progress report, and of saving from a node's own disk. A node that fails loses
// what it computed since the last save.
constexpr seconds kReportEvery{10};
constexpr seconds kSaveEvery{300};

/// For Repeated: an action that prints its error instead of throwing. It is repeated next time.
std::function<void()> tried(std::function<void()> action, seconds interval) {
  return [interval, action = std::move(action)] {
    try {
      action();
    } catch (const std::exception& problem) {
      print_stderr("shearcell: {}; tried again in {} s\n", problem.what(), interval.count());
    }
  };
}

/// Where the task works: its own store, or with `scratch` a copy on the node's disk. It is named
/// after submission and task, so that a restarted task continues its copy.
fs::path working_folder(const fs::path& task, const std::string& scratch) {
  if (scratch.empty()) return task;
  const Store sound(task, Access::write);  // throws if it cannot be used, before it is copied
  const fs::path whole = fs::absolute(task);
  const fs::path copy = scratch_here(scratch) / fmt::format("shearcell-{}-{}",
                                                            whole.parent_path().filename().string(),
                                                            whole.filename().string());
  Store store(copy, Access::create);
  merge_stores(store, {task});
  return copy;
}

/// Removes the jobs that failed and those that depend on them. Returns whether there were any.
bool leave_failed(Store& store, std::vector<StageJob>& jobs) {
  std::set<std::string> left;
  std::erase_if(jobs, [&](const StageJob& job) {  // parents come first
    const bool leave = left.contains(job.parent) || store.run(job.id).state == RunState::failed;
    if (leave) left.insert(job.id);
    return leave;
  });
  return !left.empty();
}

void work(const WorkOptions& options, Context& context) {
  catch_batch_signals();
  // Without a slash at the end, since the names of the files beside it are derived from it.
  const fs::path task = (fs::path(context.store) / "").parent_path();
  const fs::path folder = working_folder(task, options.scratch);
  const bool is_copy = folder != task;
  std::optional<Store> store(std::in_place, folder, Access::write);
  std::set<std::string> runs;  // of the task, which alone are merged back
  for (const RunRecord& run : store->runs()) runs.insert(run.id);
  const auto report = [&] { write_task_report(task, store->runs()); };
  const auto save = [&] {
    Store own(task, Access::write);
    merge_stores(own, {folder}, runs);
  };
  CampaignResult result;
  bool failed_before = false;
  {
    report();
    const Repeated reports(kReportEvery, tried(report, kReportEvery));
    std::optional<Repeated> saves;
    if (is_copy) saves.emplace(kSaveEvery, tried(save, kSaveEvery));
    std::vector<StageJob> jobs = stages_to_resume(*store, {});
    if (options.leave_failed) failed_before = leave_failed(*store, jobs);
    Progress progress(jobs.size());
    result = run_campaign(*store, jobs, options.jobs, progress, {options.threads, 1});
  }
  report();
  if (is_copy) {
    save();
    store.reset();
    fs::remove_all(folder);
  }
  print_result(result, context);
  if (stop_requested()) {
    // If work is left, the task continues later, whatever else happened.
    const bool work_left = result.interrupted + result.blocked > 0;
    if (work_left || context.exit_code == kInterrupted) {
      context.exit_code = work_left ? kInterrupted : kDone;
    }
  }
  if (failed_before && context.exit_code == kDone) context.exit_code = kRunFailed;
}

}  // namespace

void add_work(CLI::App& app, Context& context) {
  auto options = std::make_shared<WorkOptions>();
  CLI::App* command =
      app.add_subcommand("work", "Compute one task of a cluster job that `submit` queued");
  add_number(*command, "--jobs,-j", options->jobs, "Runs at a time (default: 1)", "J", 1, 1024);
  add_threads_option(*command, options->threads, "Threads inside each run (default: 1)");
  command
      ->add_option("--scratch", options->scratch,
                   "Work on a copy of the store in this folder, on the node's own disk; $NAME and "
                   "${NAME} are variables of the node")
      ->type_name("DIR");
  command->add_flag("--leave-failed", options->leave_failed, "Do not try failed runs again");
  add_common_options(*command, context);
  command->footer(
      R"(--store names the task's store. On SIGTERM or SIGUSR1 it writes checkpoints and ends with code
85; started again, it continues bit for bit. With --scratch, copies the store back every five
minutes and at the end.
Examples:
  shearcell work --store shearcell-store/submissions/3f9a12bc45de/task-1 -j 2)");
  command->callback([options, &context] { work(*options, context); });
}

}  // namespace shearcell::cli
