// SPDX-License-Identifier: GPL-3.0-or-later
// Submissions to a cluster, as recorded in the store's log, and their state.
//
// CampaignSubmitted is recorded before the jobs are queued, and JobQueued afterwards. The jobs have
// the submission's name, so they are found in the queue even after a crash between the two events.
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
  std::string merge_job;  ///< "fold_job" in the log, for submissions that are queued already
  std::vector<QueuedTask> queue;  ///< its lines of the queue, by ask_queue()

  std::string name() const { return "shearcell-" + id; }  ///< of the array job
  std::string merge_name() const { return name() + "-fold"; }
  std::filesystem::path folder(const std::filesystem::path& store) const {
    return store / "submissions" / id;
  }
  std::filesystem::path task_store(const std::filesystem::path& store, std::size_t task) const {
    return folder(store) / ("task-" + std::to_string(task));
  }
};

/// Oldest first. Throws StoreDamaged when the payload of an event is invalid.
std::vector<Submission> read_submissions(const Store& store);

/// Submissions with a folder in this store and with runs for which has_work_left().
std::vector<Submission> unfinished_submissions(const Store& store);

/// Adds to each its lines of the queue. Asks Slurm only if there are submissions. Throws
/// ProgramError.
void ask_queue(std::vector<Submission>& submissions);

/// Runs that are queued or being computed: those of submissions in the queue, those that programs
/// on this machine hold, and the packings of both that are not settled yet.
std::set<std::string> busy_runs(const Store& store, const std::vector<Submission>& open);

/// Merges the stores of a submission's tasks into the store. Task stores that no longer exist are
/// skipped.
std::vector<MergeReport> merge_tasks(Store& store, const Submission& submission);

/// Records a submission of these shares and makes a store for each task with copies of all records
/// of its runs. `facts` is added to the event. Throws ConcurrencyConflict when another program
/// submitted since `seen` such events were read.
Submission prepare_submission(Store& store, const std::vector<Share>& shares, nlohmann::json facts,
                              std::size_t seen);

/// The progress of one run, from a small file beside the store of its task. No other machine opens
/// that store while the task runs, because SQLite's locks may not work between machines.
struct ReportedRun {
  RunState state = RunState::declared;
  double cycle = 0;
};

/// Writes `FOLDER.progress.json`, whole or not at all, for the task's store FOLDER.
void write_task_report(const std::filesystem::path& folder, const std::vector<RunRecord>& runs);

/// By run id; empty when the file is missing or invalid.
std::map<std::string, ReportedRun> read_task_report(const std::filesystem::path& folder);

struct QueuedRun {
  /// Its job is "17_3" for task 3 of array job 17, or "" if it was never queued. Its state is
  /// "pending", "running", ..., or "ended" after it left the queue.
  QueuedTask task;
  std::optional<ReportedRun> reported;
};

struct QueueView {
  std::map<std::string, QueuedRun> runs;  ///< by id: runs of open submissions, and their packings
  std::vector<Submission> submissions;    ///< the open ones
  std::string problem;                    ///< why the queue could not be asked; "" if it was
  bool busy() const;                      ///< whether anything is in the queue
};

/// Asks Slurm only if the store has unfinished submissions.
QueueView view_queue(const Store& store);

/// One line for `status`: its jobs and their states, or what to do if they have ended.
std::string describe(const Submission& submission);

}  // namespace shearcell
