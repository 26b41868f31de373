// SPDX-License-Identifier: GPL-3.0-or-later
// The state of submitted runs: their place in the queue and the reports of their tasks.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/cluster/submission.hpp"

namespace shearcell {

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
  std::string job;    ///< "17_3": task 3 of array job 17; "" when it was never queued
  std::string state;  ///< "pending", "running", ...; "ended" when it left the queue
  std::string reason;
  std::string node;
  std::optional<ReportedRun> reported;
};

struct QueueView {
  std::map<std::string, QueuedRun> runs;  ///< by id: those of open submissions, and their packings
  std::vector<OpenSubmission> submissions;
  std::string problem;  ///< why the queue could not be asked; "" when it was
  bool busy() const;    ///< whether anything is in the queue
};

/// Asks Slurm only when the store knows submissions with unfinished runs.
QueueView look_at_queue(const Store& store);

/// "job 17: 2 running, 4 pending; job 18 folds", or what to do when it has ended.
std::string describe(const OpenSubmission& submission);

}  // namespace shearcell
