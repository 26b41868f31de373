// SPDX-License-Identifier: GPL-3.0-or-later
// The tilt of the side walls as a function of the step number: theta(t) = A sin(omega t).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene.hpp"

namespace shearcell {

struct Tilt {
  double theta = 0;  ///< [rad]
  double rate = 0;   ///< dtheta / d(omega t) [rad]; the caller multiplies by omega
};

/// Tilt at `step` of the stage. theta is exactly 0 at the end of each cycle and during pauses.
Tilt tilt(const Drive& drive, std::uint64_t step);

/// Number of steps in one cycle, including the pause.
inline std::uint64_t cycle_steps(const Drive& drive) {
  return drive.steps_per_cycle + drive.pause_steps;
}

/// Steps nearest to the given fractions of a cycle, in ascending order without duplicates.
/// Fractions outside (0, 1) are left out, and so are steps at the beginning or end of the cycle.
std::vector<std::uint64_t> steps_at(std::span<const double> phases, const Drive& drive);

/// Whether the moving wall is held fixed between `step` and `step + 1`.
inline bool holds_wall(const Drive& drive, std::uint64_t step) {
  return drive.pause_walls == PauseWalls::held &&
         step % cycle_steps(drive) >= drive.steps_per_cycle;
}

}  // namespace shearcell
