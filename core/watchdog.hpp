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
  double overlap = 0.1;  ///< largest overlap of two grains, or of a grain and a wall plane [d]
  double escape = 0.5;   ///< farthest a centre may be behind a wall plane [d]
  double time_step = 1;  ///< largest, over the stability limit of the contacts (below)
};

/// What the watchdog looks at; arrays as in kernel.hpp.
struct WatchTask {
  const double* rows = nullptr;
  const double* velocity[3] = {};
  const std::vector<std::int32_t>* id = nullptr;
  NeighbourRows neighbours;
  std::size_t lanes = 1;
  std::uint64_t step = 0;
  double time_step = 0;      ///< of the steps being taken [s]; 0 where no time passes
  double wall_height = 0;    ///< of the moving wall [d]
  double wall_velocity = 0;  ///< [d/s]
};

/// Checks that every number is finite, every grain inside the walls, no overlap above its limit,
/// no grain faster than all the energy of twelve contacts at that limit could have thrown it, and
/// the time step below 2/omega for every omega that the contacts can vibrate with. That is bounded
/// grain by grain: since (a - b)^2 <= (1 + c) a^2 + (1 + 1/c) b^2, omega^2 is at most k/m times the
/// largest eigenvalue of any grain's sum of w n n^T over its contacts, w = 2 with a grain, 1 with
/// a wall that stands, 5/4 with the moving wall, and of 5 (sum of n_y^2) / M for that wall itself.
/// The bound is met by a pair (2 k/m) and by an FCC crystal (8 k/m).
/// Costs about four time steps. Throws NumericalFailure for the first grain in memory found so.
void check_grains(const WatchTask& task, const Cell& cell, const Scene& scene, const WallPose& pose,
                  const WatchdogLimits& limits);

}  // namespace shearcell
