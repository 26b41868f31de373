// SPDX-License-Identifier: GPL-3.0-or-later
// A submission: an array job whose tasks, each with a store of its own, share the work that is
// left, and a job that merges the stores of the tasks.
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

/// Work for one task. Runs that start from one packing stay together, so that the packing is
/// settled once.
struct Share {
  std::vector<std::string> packings;  ///< ids of the `prepare` stages
  std::vector<std::string> runs;      ///< ids of the unfinished stages that start from them
  double particle_steps = 0;          ///< left, the packings included
  double core_seconds = 0;            ///< for these, at the rates of the engines

  void add(const Share& other);
};

/// The runs of the plans that are not done in the store (which may be null), each once. One share
/// for each packing, in the order of the plans.
std::vector<Share> shares_of(const std::vector<Plan>& plans, const Store* store);

/// Joins the shares of packings into at most `tasks` shares, none empty: the longest packing first,
/// each to the task with the least core time so far. The same input gives the same shares.
std::vector<Share> share_out(std::vector<Share> packings, std::size_t tasks);

/// Options for Slurm. Empty texts leave the choice to the cluster.
struct JobOptions {
  std::string partition;
  std::string account;
  std::string time;                 ///< limit of one start of a task, in Slurm's own form
  std::size_t cpus = 0;             ///< of a task; 0 if not chosen yet
  std::size_t threads = 1;          ///< inside each run
  std::size_t warn_seconds = 120;   ///< before the limit
  std::vector<std::string> sbatch;  ///< further options, as "--qos=long"
  std::string scratch;              ///< see unfit_scratch()
};

struct Proposal {
  std::vector<Share> shares;
  std::size_t left_out = 0;  ///< runs that are already queued or being computed
  JobOptions job;            ///< with the number of cores chosen

  /// Expected wall time [s] of one task with all its cores busy.
  double seconds(const Share& share) const;
};

/// Leaves out every packing that is busy or has a busy run, with its runs. If `job.cpus` is 0, a
/// task gets one core for each thread of each of its runs: at most 16, but enough for one run.
Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job);

struct Submission {
  std::string id;                               ///< 12 hex digits
  std::vector<std::vector<std::string>> tasks;  ///< runs of task 1, 2, ...
  std::string job;                              ///< "" when it was not queued
  std::string merge_job;          ///< "fold_job" in the log, as submissions of earlier versions
  std::vector<QueuedTask> queue;  ///< its lines of the queue, by view_queue()

  std::string name() const { return "shearcell-" + id; }  ///< of the array job
  std::string merge_name() const { return name() + "-fold"; }
  std::filesystem::path folder(const std::filesystem::path& store) const {
    return store / "submissions" / id;
  }
  std::filesystem::path task_store(const std::filesystem::path& store, std::size_t task) const {
    return folder(store) / ("task-" + std::to_string(task));
  }
};

/// The array job: task n works on its store, ends with the program's exit code, and is queued again
/// when its time is over.
Job array_job(const Submission& submission, const std::filesystem::path& store,
              const JobOptions& options);

/// Merges the store of every task into `store`, one after the other, when the job of number `array`
/// has ended. Ends with the last exit code that was not 0.
Job merge_job(const Submission& submission, const std::filesystem::path& store,
              const JobOptions& options, const std::string& array);

/// Makes a store for each task, with copies of all records of its runs, and records the submission:
/// `facts`, the runs of each task and the command. Throws ConcurrencyConflict when another program
/// has submitted since the caller read the first `seen` submissions.
Submission prepare_submission(Store& store, const Proposal& proposal, nlohmann::json facts,
                              std::size_t seen);

/// Oldest first. Throws StoreDamaged when the payload of an event is invalid.
std::vector<Submission> read_submissions(const Store& store);

/// Submissions with a folder in this store and with runs that are not done by their Outlook.
std::vector<Submission> unfinished_submissions(const Store& store);

/// Merges the stores of a submission's tasks that still exist into the store. Returns the number of
/// new checkpoints.
std::uint64_t merge_tasks(Store& store, const Submission& submission);

/// Runs that are queued or being computed: runs of submissions in the queue, runs that programs on
/// this machine hold, and the unsettled packings of these runs.
std::set<std::string> busy_runs(const Store& store, const std::vector<Submission>& open);

/// Writes `FOLDER.progress.json`, whole or not at all, for the task's store FOLDER. No other
/// machine opens that store while the task runs, because SQLite's locks may not work between
/// machines.
void write_task_report(const std::filesystem::path& folder, const std::vector<Stage>& runs);

/// The id, state and cycle of each run, by id; empty when the file is missing or invalid.
std::map<std::string, Stage> read_task_report(const std::filesystem::path& folder);

struct QueuedRun {
  /// Its job is "17_3" for task 3 of array job 17, or "" if it was never queued. Its state is
  /// "pending", "running", ..., or "ended" after it left the queue.
  QueuedTask task;
  std::optional<Stage> reported;  ///< by its task
};

struct QueueView {
  std::vector<Submission> submissions;    ///< the unfinished ones
  std::map<std::string, QueuedRun> runs;  ///< by id: their runs and packings
  std::string problem;                    ///< why the queue could not be asked; "" if it was
};

/// Asks Slurm only if the store has unfinished submissions.
QueueView view_queue(const Store& store);

/// One line for `status`: its jobs and their states, or what to do if they have ended.
std::string describe(const Submission& submission);

}  // namespace shearcell
