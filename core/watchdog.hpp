// SPDX-License-Identifier: GPL-3.0-or-later
// Stops a simulation that has gone wrong, with the numbers that say why.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

/// A run left the range in which its results mean anything.
class NumericalFailure : public std::runtime_error {
 public:
  NumericalFailure(const std::string& quantity, double value, double limit, std::int64_t grain,
                   std::uint64_t step, const std::string& remedy);
  std::string quantity;
  double value;
  double limit;
  std::int64_t grain;  ///< permanent id, or -1
  std::uint64_t step;
};

struct WatchdogLimits {
  double overlap = 0.1;  ///< largest overlap of two grains [d]
  double escape = 0.5;   ///< farthest a centre may be outside a wall plane [d]
};

/// Checks that every number is finite, every grain inside the walls, no overlap above its limit and
/// no grain faster than a free one that all its contact energy at that limit could have thrown.
/// Cost: about that of two time steps. Throws NumericalFailure.
void check_state(const Cell& cell, const Scene& scene, const State& state, const WallPose& pose,
                 const WatchdogLimits& limits);

}  // namespace shearcell
