// SPDX-License-Identifier: GPL-3.0-or-later
// Submissions to a cluster, as recorded in the store's log, and their state.
//
// CampaignSubmitted is recorded before the jobs are queued and JobQueued after; the jobs have the
// submission's name, so the queue can be asked about them even if a crash falls in between.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
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

  std::string name() const { return "shearcell-" + id; }  ///< of the array job
  std::string fold_name() const { return name() + "-fold"; }
  std::filesystem::path folder(const std::filesystem::path& store) const {
    return store / "submissions" / id;
  }
  std::filesystem::path task_store(const std::filesystem::path& store, std::size_t task) const {
    return folder(store) / ("task-" + std::to_string(task));
  }
};

/// A submission that may still have work in it, and its lines of the queue.
struct OpenSubmission {
  Submission submission;
  std::vector<QueuedTask> queue;
};

/// Oldest first. Throws StoreDamaged when an event does not hold what it must.
std::vector<Submission> read_submissions(const Store& store);

/// Those that are in this store's folder and have runs that the store does not hold completed.
std::vector<OpenSubmission> unfinished_submissions(const Store& store);

/// Adds what the queue says of each. Asks Slurm only when there are any. Throws ClusterError.
void ask_queue(std::vector<OpenSubmission>& submissions);

/// Runs that somebody computes now, or will: those of submissions in the queue, and those that
/// programs on this machine hold; and packings that they start from and have yet to settle.
std::set<std::string> busy_runs(const Store& store, const std::vector<OpenSubmission>& open);

/// Folds in what the tasks of a submission recorded. Task stores that no longer exist are skipped.
std::vector<MergeReport> fold(Store& store, const Submission& submission);

/// Records a submission of these shares and makes a store for each task, holding what is known of
/// its runs. `facts` joins the event. Throws ConcurrencyConflict when another program submitted
/// since `seen` such events were read.
Submission prepare_submission(Store& store, const std::vector<Share>& shares, nlohmann::json facts,
                              std::size_t seen);

}  // namespace shearcell
