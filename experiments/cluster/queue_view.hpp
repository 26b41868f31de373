// SPDX-License-Identifier: GPL-3.0-or-later
// The state of submitted runs: their place in the queue and the reports of their tasks.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/cluster/submission.hpp"
#include "experiments/cluster/task_report.hpp"

namespace shearcell {

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
