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

/// Work for one task. Runs that start from one packing stay together, so that it is settled once.
struct Share {
  std::vector<std::string> packings;  ///< ids of the `prepare` stages
  std::vector<std::string> runs;      ///< ids of the stages left that start from them, as planned
  double particle_steps = 0;          ///< left, the packings' own included
  double core_seconds = 0;            ///< that these take at the rates of their engines

  void add(const Share& other);
};

/// Every run of the plans that the store, which may be null, does not hold completed at its length;
/// each once, in the order of the plans, a share for each packing.
std::vector<Share> work_left(const std::vector<Plan>& plans, const Store* store);

/// Distributes the shares of packings, the longest first, each to the task with the least core
/// time; equal ones in turn. At most `tasks` shares, none empty. The same input gives the same
/// shares.
std::vector<Share> share_out(std::vector<Share> packings, std::size_t tasks);

struct Proposal {
  std::vector<Share> shares;
  std::size_t left_out = 0;  ///< runs that are in the queue or at work already
  JobOptions job;            ///< with a number of cores
};

/// Leaves out every packing that is busy or has a busy run, with its runs. If the number of cores
/// in `job` is 0, a task gets one for each thread of each of its runs: at most 16, at least those
/// of one run.
Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job);

/// Expected of one task, when all its cores are busy.
double seconds_of(const Share& share, const Proposal& proposal);

}  // namespace shearcell
