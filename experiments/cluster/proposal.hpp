// SPDX-License-Identifier: GPL-3.0-or-later
// What to submit: the stages of some plans that are not done and not held, divided among tasks.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "experiments/cluster/job_script.hpp"
#include "experiments/cluster/share.hpp"
#include "experiments/cluster/submission.hpp"
#include "experiments/runner/cost.hpp"

namespace shearcell {

struct Proposal {
  std::vector<Share> shares;
  std::size_t left_out = 0;  ///< runs that are in the queue or at work already
  JobOptions job;            ///< with a number of cores
  Rate rate{};
};

/// Runs that somebody computes now, or will: those of submissions in the queue, and those that
/// programs on this machine hold; and packings that they start from and have yet to settle.
std::set<std::string> busy_runs(const Store& store, const std::vector<OpenSubmission>& open);

/// Leaves out every bundle with a busy run or packing. Where `job` states no number of cores (0), a
/// task gets one for each of its runs and threads, 16 at most but those of one run.
Proposal propose(const std::vector<Plan>& plans, const std::vector<RunRecord>& known,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job);

/// Expected of one task, when all its cores are busy.
double seconds_of(const Share& share, const Proposal& proposal);

}  // namespace shearcell
