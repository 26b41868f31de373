// SPDX-License-Identifier: GPL-3.0-or-later
// The reference for the engine: the contact law summed over all pairs, without any list. Its
// arithmetic is that of core's contact law, wall pose and tilt, which tests/core/numbers_test.cpp
// compares with their definitions.
#pragma once

#include "core/simulation.hpp"

namespace shearcell::test {

/// Forces of springs, over the stiffness [d].
struct Pushes {
  Eigen::Matrix3Xd on_grain;
  double of_moving_wall = 0;  ///< along y, on all grains
};

Pushes pushes_over_all_pairs(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& at);

/// One time step, in the order of operations that Simulation promises: the same bits.
void step_over_all_pairs(const Cell& cell, const Scene& scene, const Drive& drive, State& state);

}  // namespace shearcell::test
