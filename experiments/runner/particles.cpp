// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/particles.hpp"

#include <cmath>

#include "analysis/voronoi.hpp"

namespace shearcell {

Particles particles_of(const Cell& cell, const WallPose& pose, const State& state,
                       double shear_rate, const Units& units) {
  const double d = units.diameter_m;
  const Eigen::Index grains = state.position.cols();
  const Eigen::Matrix3Xd sites = wrapped_sites(cell, pose, state.position);
  Particles all;
  all.grains = static_cast<std::size_t>(grains);
  all.radius = d / 2;
  all.mass = units.mass_kg;
  all.position = sites * d;
  all.velocity.resize(3, sites.cols());
  all.velocity << state.velocity * d,
      wall_grain_velocities(cell, pose, shear_rate, state.wall_velocity) * d;
  const double height = (pose.top - pose.bottom) * d;
  const double shift = height * pose.tan_theta;
  all.origin = Eigen::Vector3d(-shift, pose.bottom * d, 0);
  all.edges << cell.width * d, shift, 0,  //
      0, height, 0,                       //
      0, 0, cell.depth * d;
  for (Eigen::Index i = 0; i < grains; ++i) {
    const double periods = (state.position(2, i) - sites(2, i)) / cell.depth;
    all.image.push_back(static_cast<std::int32_t>(std::lround(periods)));
    all.type.push_back(0);
  }
  for (const WallGrain& grain : cell.wall_grains) {
    all.image.push_back(0);
    all.type.push_back(1 + static_cast<std::int32_t>(grain.side));
  }
  return all;
}

}  // namespace shearcell
