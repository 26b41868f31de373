// SPDX-License-Identifier: GPL-3.0-or-later
// Which stages of a campaign are left to do, and which task of an array job computes which.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "experiments/manifest/expand.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// Runs that start from one packing. They stay together, so that it is settled once.
struct Bundle {
  std::string packing;            ///< id of the `prepare` stage
  std::vector<std::string> runs;  ///< ids of the stages left that start from it, as planned
  double particle_steps = 0;      ///< left, the packing's own included
};

/// What one task computes.
struct Share {
  std::vector<std::string> runs;  ///< ids of the stages to compute, without their packings
  std::set<std::string> stages;   ///< ids of these and of the packings that they start from
  std::size_t packings = 0;
  double particle_steps = 0;
};

/// Every run of the plans that `known`, the store's runs, does not hold completed at its length;
/// each once, in the order of the plans.
std::vector<Bundle> work_left(const std::vector<Plan>& plans, const std::vector<RunRecord>& known);

/// Distributes the bundles, the largest first, each to the task with the least work; equal ones in
/// turn. At most `tasks` shares, none empty. The same bundles give the same shares.
std::vector<Share> share_out(std::vector<Bundle> bundles, std::size_t tasks);

}  // namespace shearcell
