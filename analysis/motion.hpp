// SPDX-License-Identifier: GPL-3.0-or-later
// How grains moved between two checkpoints of one run.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "provenance/checkpoint.hpp"

namespace shearcell {

/// Neighbours of a grain for its motion are at most this far away [d]: about the first minimum of
/// g(r).
inline constexpr double motion_neighbour_d = 1.5;
/// A grain returned if it is within this distance of where it was [d].
inline constexpr double reversible_d = 0.01;

/// One column or entry per grain, by grain id.
struct Motion {
  /// In the frame of the tilted walls, x - (y - y_top) tan(theta), so that a cell that has only
  /// been sheared moves no grain [d].
  Eigen::Matrix3Xd displacement;
  /// D^2_min of Falk and Langer, Phys. Rev. E 57, 7192 (1998), as a mean over the neighbours at the
  /// earlier time [d^2]: what is left of their relative motion after the best affine deformation.
  /// Not a number for a grain with fewer than four neighbours, or all in one plane.
  std::vector<double> nonaffine;
};

/// Throws AnalysisError if the checkpoints do not have the same grains.
Motion motion(const Checkpoint& earlier, const Checkpoint& later);

/// One entry per grain: 1 for a crystalline grain with a neighbour, at most motion_neighbour_d
/// away, that is not crystalline; else 0. `crystalline` has 1 or 0 for each grain.
std::vector<std::uint8_t> crystal_boundary(const Checkpoint& checkpoint,
                                           std::span<const std::uint8_t> crystalline);

}  // namespace shearcell
