// SPDX-License-Identifier: GPL-3.0-or-later
// A submission: an array job, whose tasks share the remaining work and have one store each, and a
// job that merges the stores of the tasks.
//
// CampaignSubmitted is recorded in the log before the jobs are queued, and JobQueued afterwards.
// The jobs have the submission's name, so they are found in the queue even after a crash between
// the two events.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiments/cluster/slurm.hpp"
#include "experiments/manifest/expand.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Work for one task. Runs that start from the same packing stay together, so that the packing is
/// settled only once.
struct Share {
  std::vector<std::string> packings;  ///< ids of the `prepare` stages
  std::vector<std::string> runs;      ///< ids of the unfinished stages that start from `packings`
  double particle_steps = 0;          ///< remaining work; includes settling the packings
  double core_seconds = 0;            ///< time on one core [s], estimated with Rates (outlook.hpp)
};

/// Returns one share for each packing with unfinished runs, in the order of the plans. A run that
/// several plans contain is listed once. `store` may be null.
std::vector<Share> shares_of(const std::vector<Plan>& plans, const Store* store);

/// Merges the shares `packings` (from shares_of(), one for each packing) into at most `tasks` new
/// shares. Adds `packings` in order of descending core time, each to the new share with the least
/// core time so far. No new share is empty. The same input gives the same new shares.
std::vector<Share> share_out(std::vector<Share> packings, std::size_t tasks);

struct JobOptions {
  std::size_t cpus = 0;             ///< cores of a task; 0 if not chosen yet
  std::size_t threads = 1;          ///< threads of each run
  std::size_t warn_seconds = 120;   ///< time between Slurm's warning and the limit
  std::vector<std::string> sbatch;  ///< options of sbatch, such as "--partition=long"
  std::string scratch;              ///< see unfit_scratch()
};

struct Proposal {
  std::vector<Share> shares;
  std::size_t left_out = 0;  ///< runs that are already queued or being computed
  JobOptions job;            ///< the options with the chosen `cpus`

  /// Expected wall time [s] of a task for this share.
  double seconds(const Share& share) const;
};

/// Divides the packings of the plans, each with all its runs, into shares. A packing is left out if
/// `busy` contains it or one of its runs. Each share is one task. If `job.cpus` is 0, all tasks get
/// the same number of cores: `job.threads` times the number of runs in the largest share, but at
/// most max(16, `job.threads`).
Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job);

struct Submission {
  std::string id;                               ///< 12 hex digits
  std::vector<std::vector<std::string>> tasks;  ///< runs of task 1, 2, ...
  std::string job;                              ///< number of the array job; "" if not queued
  std::string merge_job;                        ///< number of the merge job (event key "fold_job")
  std::vector<QueuedTask> queue;                ///< this submission's tasks in Slurm's queue

  std::string name() const { return "shearcell-" + id; }  ///< name of the array job
  std::string merge_name() const { return name() + "-fold"; }
  std::filesystem::path folder(const std::filesystem::path& store) const {
    return store / "submissions" / id;
  }
  std::filesystem::path task_store(const std::filesystem::path& store, std::size_t task) const {
    return folder(store) / ("task-" + std::to_string(task));
  }
};

/// The array job. Task n works on its own store and ends with the program's exit code. A task that
/// reaches its time limit is queued again.
Job array_job(const Submission& submission, const std::filesystem::path& store,
              const JobOptions& options);

/// The merge job, which starts after job number `array` has ended. Merges the stores of all tasks
/// into `store`, one after the other. Its exit code is that of the last failed merge, or 0.
Job merge_job(const Submission& submission, const std::filesystem::path& store,
              const JobOptions& options, const std::string& array);

/// Makes a store for each task, with copies of all records of its runs. Then records an event with
/// the runs of each task, the command, and the entries of `facts`. `seen`: number of submission
/// events that the caller has read. Throws ConcurrencyConflict if another program has added a
/// submission event since.
Submission prepare_submission(Store& store, const Proposal& proposal, nlohmann::json facts,
                              std::size_t seen);

/// All submissions of the store, oldest first. Throws StoreDamaged if an event is invalid.
std::vector<Submission> read_submissions(const Store& store);

/// Submissions with a folder in this store and at least one run that is not done (Outlook::done).
std::vector<Submission> unfinished_submissions(const Store& store);

/// Merges the existing task stores of a submission into `store`. Returns the number of new
/// checkpoints.
std::uint64_t merge_tasks(Store& store, const Submission& submission);

/// Runs that are queued or being computed: all runs of submissions with jobs in the queue, all runs
/// that a process is computing, and the unsettled packings of these runs.
std::set<std::string> busy_runs(const Store& store, const std::vector<Submission>& open);

/// Writes `FOLDER.progress.json` for the task's store FOLDER, in one atomic step. While the
/// task runs, other machines read this file instead of the task's store, because SQLite's locks may
/// not work between machines.
void write_task_report(const std::filesystem::path& folder, const std::vector<Stage>& runs);

/// State and cycle of each run, by id, from FOLDER.progress.json; empty if the file is not valid.
std::map<std::string, Stage> read_task_report(const std::filesystem::path& folder);

struct QueuedRun {
  /// The task that computes the run. `job` is "17_3" for task 3 of array job 17, or "" if the job
  /// was never queued. `state` is "pending", "running", ..., or "ended" after the task left the
  /// queue.
  QueuedTask task;
  std::optional<Stage> reported;  ///< by the task
};

struct QueueView {
  std::vector<Submission> submissions;    ///< unfinished submissions
  std::map<std::string, QueuedRun> runs;  ///< runs and packings of submissions, by id
  std::string problem;                    ///< why the queue could not be read, or ""
};

/// Reads Slurm's queue if the store has unfinished submissions.
QueueView view_queue(const Store& store);

/// One line for `status`: the jobs of a submission and their states, or advice if no job is left.
std::string describe(const Submission& submission);

}  // namespace shearcell
