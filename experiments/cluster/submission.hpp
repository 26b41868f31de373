// SPDX-License-Identifier: GPL-3.0-or-later
// Submissions to a cluster, as recorded in the store's log, and their state.
//
// CampaignSubmitted is recorded before the jobs are queued and JobQueued after; the jobs have the
// submission's name, so the queue can be asked about them even if a crash falls in between.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiments/cluster/proposal.hpp"
#include "experiments/cluster/slurm.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct Submission {
  std::string id;                               ///< 12 hex digits
  std::vector<std::vector<std::string>> tasks;  ///< runs of task 1, 2, ...
  std::string job;                              ///< "" when it was not queued
  std::string fold_job;
  std::vector<QueuedTask> queue;  ///< its lines of the queue, once that was asked

  std::string name() const { return "shearcell-" + id; }  ///< of the array job
  std::string fold_name() const { return name() + "-fold"; }
  std::filesystem::path folder(const std::filesystem::path& store) const {
    return store / "submissions" / id;
  }
  std::filesystem::path task_store(const std::filesystem::path& store, std::size_t task) const {
    return folder(store) / ("task-" + std::to_string(task));
  }
};

/// Oldest first. Throws StoreDamaged when an event does not hold what it must.
std::vector<Submission> read_submissions(const Store& store);

/// Those that are in this store's folder and have runs that are not completed in the store, or lack
/// checkpoints there.
std::vector<Submission> unfinished_submissions(const Store& store);

/// Adds what the queue says of each. Asks Slurm only when there are any. Throws ProgramError.
void ask_queue(std::vector<Submission>& submissions);

/// Runs that somebody computes now, or will: those of submissions in the queue, and those that
/// programs on this machine hold; and packings that they start from and have yet to settle.
std::set<std::string> busy_runs(const Store& store, const std::vector<Submission>& open);

/// Folds in what the tasks of a submission recorded. Task stores that no longer exist are skipped.
std::vector<MergeReport> fold(Store& store, const Submission& submission);

/// Records a submission of these shares and makes a store for each task, holding what is known of
/// its runs. `facts` joins the event. Throws ConcurrencyConflict when another program submitted
/// since `seen` such events were read.
Submission prepare_submission(Store& store, const std::vector<Share>& shares, nlohmann::json facts,
                              std::size_t seen);

/// The progress of a task is in a small file beside its store. No other machine opens the store
/// itself while the task runs, because SQLite's locks may not work between machines.
struct ReportedRun {
  RunState state = RunState::declared;
  double cycle = 0;
};

/// Puts `FOLDER.progress.json` there, whole or not at all, for the task's store FOLDER.
void write_task_report(const std::filesystem::path& folder, const std::vector<RunRecord>& runs);

/// By run id; empty when there is no such file or it cannot be understood.
std::map<std::string, ReportedRun> read_task_report(const std::filesystem::path& folder);

struct QueuedRun {
  /// The job is "17_3", task 3 of array job 17, or "" when it was never queued; the state is
  /// "pending", "running", ..., or "ended" when it left the queue.
  QueuedTask task;
  std::optional<ReportedRun> reported;
};

struct QueueView {
  std::map<std::string, QueuedRun> runs;  ///< by id: those of open submissions, and their packings
  std::vector<Submission> submissions;
  std::string problem;  ///< why the queue could not be asked; "" when it was
  bool busy() const;    ///< whether anything is in the queue
};

/// Asks Slurm only when the store knows submissions with unfinished runs.
QueueView look_at_queue(const Store& store);

/// "job 17: 2 running, 4 pending; job 18 folds", or what to do when it has ended.
std::string describe(const Submission& submission);

}  // namespace shearcell
