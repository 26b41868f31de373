// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that changes during a simulation. A run continues from it bit for bit.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace shearcell {

/// Column i belongs to the grain with permanent id i. Velocities are those of the leapfrog, half a
/// time step before `step`. Forces depend on positions alone, so nothing else is needed.
struct State {
  std::uint64_t step = 0;     ///< time steps since the stage began
  Eigen::Matrix3Xd position;  ///< 3 x N [d]; z is unwrapped
  Eigen::Matrix3Xd velocity;  ///< 3 x N [d/s], at step - 1/2
  double wall_height = 0;     ///< y of the moving wall's plane [d]
  double wall_velocity = 0;   ///< its velocity [d/s], at step - 1/2
};

}  // namespace shearcell
