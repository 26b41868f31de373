// SPDX-License-Identifier: GPL-3.0-or-later
// All data that change during a simulation. A run continues from a state bit for bit.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace shearcell {

/// Column i belongs to the grain with permanent id i. Velocities are leapfrog velocities, half a
/// time step before `step`. Forces depend only on positions, so a restart needs no other data.
struct State {
  std::uint64_t step = 0;     ///< time steps since the stage began
  Eigen::Matrix3Xd position;  ///< 3 x N [d]; z is unwrapped
  Eigen::Matrix3Xd velocity;  ///< 3 x N [d/s], at step - 1/2
  double wall_height = 0;     ///< y of the moving wall's plane [d]
  double wall_velocity = 0;   ///< velocity of the moving wall [d/s], at step - 1/2
};

}  // namespace shearcell
