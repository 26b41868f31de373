// SPDX-License-Identifier: GPL-3.0-or-later
// What to submit: stages of plans that are neither done nor being computed, divided among tasks.
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
  std::vector<std::string> runs;      ///< ids of the unfinished stages that start from them
  double particle_steps = 0;          ///< left, including those of the packings
  double core_seconds = 0;            ///< for these, at the rates of the engines

  void add(const Share& other);
};

/// The runs of the plans that are not done in the store (which may be null), each once. One share
/// for each packing, in the order of the plans.
std::vector<Share> work_left(const std::vector<Plan>& plans, const Store* store);

/// Distributes the shares of packings, the longest first, each to the task with the least core
/// time; equal ones in turn. At most `tasks` shares, none empty. The same input gives the same
/// shares.
std::vector<Share> share_out(std::vector<Share> packings, std::size_t tasks);

struct Proposal {
  std::vector<Share> shares;
  std::size_t left_out = 0;  ///< runs that are already queued or being computed
  JobOptions job;            ///< with the number of cores chosen
};

/// Leaves out every packing that is busy or has a busy run, with its runs. If `job.cpus` is 0, a
/// task gets one core for each thread of each of its runs, but at most 16, and at least the cores
/// of one run.
Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job);

/// Expected wall time [s] of one task with all its cores busy.
double seconds_of(const Share& share, const Proposal& proposal);

}  // namespace shearcell
