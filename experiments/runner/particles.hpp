// SPDX-License-Identifier: GPL-3.0-or-later
// A state for other programs: every particle, wall grains included, and the box, in units that the
// caller chooses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

/// The grains by id, then the wall grains in the order of the cell. Arrays have one entry, or one
/// column, per particle. particles_of() sets the units: SI in an export.
struct Particles {
  /// The cell: its lower left corner, and its edges as columns. Only the third is periodic.
  Eigen::Vector3d origin;
  Eigen::Matrix3d edges;

  std::size_t grains = 0;           ///< the first of the particles
  double radius = 0;                ///< of every particle
  double mass = 0;                  ///< of every grain
  Eigen::Matrix3Xd position;        ///< z within the cell
  Eigen::Matrix3Xd velocity;        ///< a wall grain has the velocity of its wall
  std::vector<std::int32_t> image;  ///< periods in z to add for the unwrapped position
  std::vector<std::int32_t> type;   ///< 0 grain; wall grain: 1 left, 2 right, 3 bottom, 4 top

  std::size_t particles() const { return type.size(); }
};

/// Lengths in units.diameter_m and masses in units.mass_kg. Wall grains move with `shear_rate`, the
/// change of tan(theta) [1/s], and with the moving wall (x of a wall point at y: (y - y_top)
/// tan(theta)).
Particles particles_of(const Cell& cell, const WallPose& pose, const State& state,
                       double shear_rate, const Units& units);

}  // namespace shearcell
