// SPDX-License-Identifier: GPL-3.0-or-later
// The tilt of the side walls as a function of the integer step: theta(t) = A sin(omega t).
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

/// Tilt at a step since the stage began; exactly zero at the end of each cycle and while paused.
Tilt tilt(const Drive& drive, std::uint64_t step);

/// Steps of one cycle with its pause.
inline std::uint64_t cycle_steps(const Drive& drive) {
  return drive.steps_per_cycle + drive.pause_steps;
}

/// The steps nearest to these fractions of a cycle, without its beginning and end, ascending and
/// each once. Fractions that are not between 0 and 1 are left out.
std::vector<std::uint64_t> steps_at(std::span<const double> phases, const Drive& drive);

/// Whether the moving wall keeps its height from this step to the next.
inline bool holds_wall(const Drive& drive, std::uint64_t step) {
  return drive.pause_walls == PauseWalls::held &&
         step % cycle_steps(drive) >= drive.steps_per_cycle;
}

}  // namespace shearcell
