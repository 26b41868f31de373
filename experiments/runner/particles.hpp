// SPDX-License-Identifier: GPL-3.0-or-later
// All particles of a state, including wall grains, and the cell, in units that the caller chooses.
// Used for exports and for LAMMPS.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

/// The first particles are the grains, by id; the wall grains follow, as ordered in Cell. Arrays
/// have one entry or one column per particle. The caller of particles_of() chooses the units.
struct Particles {
  /// `origin`: lower left corner of the cell. `edges`: the three edge vectors of the cell, as
  /// columns. The cell is periodic only along the third edge.
  Eigen::Vector3d origin;
  Eigen::Matrix3d edges;

  std::size_t grains = 0;           ///< number of grains
  double radius = 0;                ///< of every particle
  double mass = 0;                  ///< of every grain
  Eigen::Matrix3Xd position;        ///< z is wrapped into the cell
  Eigen::Matrix3Xd velocity;        ///< a wall grain has the velocity of its wall
  std::vector<std::int32_t> image;  ///< number of periods that must be added to unwrap z
  std::vector<std::int32_t> type;   ///< 0 grain; wall grain: 1 left, 2 right, 3 bottom, 4 top

  std::size_t particles() const { return type.size(); }
};

/// `units`: diameter and mass of a grain in the units of the result. `shear_rate`: time derivative
/// of tan(theta) [1/s]. A wall grain at y is displaced by x = (y - y_top) tan(theta). Its velocity
/// follows from `shear_rate` and the velocity of the moving wall.
Particles particles_of(const Cell& cell, const WallPose& pose, const State& state,
                       double shear_rate, const Units& units);

}  // namespace shearcell
