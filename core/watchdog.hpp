// SPDX-License-Identifier: GPL-3.0-or-later
// Stops a simulation that has gone wrong, with the numbers that say why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/cell.hpp"
#include "core/kernel.hpp"
#include "core/scene.hpp"

namespace shearcell {

/// A run left the range in which its results mean anything. what() says what to change.
class NumericalFailure : public std::runtime_error {
 public:
  NumericalFailure(std::string quantity, double value, double limit, std::int64_t grain,
                   std::uint64_t step, const std::string& remedy);
  std::string quantity;
  double value;
  double limit;
  std::int64_t grain;  ///< permanent id, or -1
  std::uint64_t step;
};

struct WatchdogLimits {
  double overlap = 0.1;  ///< largest overlap of two grains [d]
  double escape = 0.5;   ///< farthest a centre may be behind a wall plane [d]
};

/// What the watchdog looks at; arrays as in kernel.hpp.
struct WatchTask {
  const double* rows = nullptr;
  const double* velocity[3] = {};
  const std::vector<std::int32_t>* id = nullptr;
  NeighbourRows neighbours;
  std::size_t lanes = 1;
  std::uint64_t step = 0;
};

/// Checks that every number is finite, every grain inside the walls, no overlap above its limit,
/// and no grain faster than all the energy of twelve contacts at that limit could have thrown it.
/// Costs about four time steps. Throws NumericalFailure for the first grain in memory found so.
void check_grains(const WatchTask& task, const Cell& cell, const Scene& scene, const WallPose& pose,
                  const WatchdogLimits& limits);

}  // namespace shearcell
