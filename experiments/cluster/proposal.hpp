// SPDX-License-Identifier: GPL-3.0-or-later
// What to submit: the stages of some plans that are not done and not held, divided among tasks.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "experiments/cluster/slurm.hpp"
#include "experiments/manifest/expand.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Runs that start from one packing. They stay together, so that it is settled once.
struct Bundle {
  std::string packing;            ///< id of the `prepare` stage
  std::vector<std::string> runs;  ///< ids of the stages left that start from it, as planned
  double particle_steps = 0;      ///< left, the packing's own included
  double core_seconds = 0;        ///< that these take at the rates of their engines
};

/// What one task computes.
struct Share {
  std::vector<std::string> runs;  ///< ids of the stages to compute, without their packings
  std::size_t packings = 0;
  double particle_steps = 0;
  double core_seconds = 0;
};

/// Every run of the plans that the store, which may be null, does not hold completed at its length;
/// each once, in the order of the plans.
std::vector<Bundle> work_left(const std::vector<Plan>& plans, const Store* store);

/// Distributes the bundles, the largest first, each to the task with the least work; equal ones in
/// turn. At most `tasks` shares, none empty. The same bundles give the same shares.
std::vector<Share> share_out(std::vector<Bundle> bundles, std::size_t tasks);

struct Proposal {
  std::vector<Share> shares;
  std::size_t left_out = 0;  ///< runs that are in the queue or at work already
  JobOptions job;            ///< with a number of cores
};

/// Leaves out every bundle with a busy run or packing. Where `job` states no number of cores (0), a
/// task gets one for each of its runs and threads, 16 at most but those of one run.
Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job);

/// Expected of one task, when all its cores are busy.
double seconds_of(const Share& share, const Proposal& proposal);

}  // namespace shearcell
