// SPDX-License-Identifier: GPL-3.0-or-later
// Observables of a state that a run records, computed contact by contact without neighbour lists.
#pragma once

#include <cstdint>
#include <functional>

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

/// One contact of a grain. `other` is a grain (kind grain), an index of Cell::wall_grains
/// (wall_grain), or a WallSide (wall_plane).
struct Contact {
  enum class Kind : std::uint8_t { grain, wall_grain, wall_plane };
  Kind kind;
  std::int32_t grain;
  std::int32_t other;
  WallSide side;           ///< of a wall contact
  double overlap;          ///< [d]
  Eigen::Vector3d normal;  ///< unit vector towards `grain`
};

/// Calls visit for every contact of `grains` (3 x N [d], z unwrapped), in ascending id of the
/// grain. A pair of grains is visited once, with grain < other.
void for_each_contact(const Cell& cell, const Eigen::Matrix3Xd& grains, const WallPose& pose,
                      const std::function<void(const Contact&)>& visit);

/// Unit of the tolerances on forces [m d/s^2]: P d^2; without pressure m g, but at least 1.
double force_unit(const Scene& scene);

struct Diagnostics {
  double kinetic_energy = 0;      ///< per grain, at the half step [m d^2/s^2]
  double mean_overlap = 0;        ///< Eq. S3 over pairs of grains [d]
  double largest_overlap = 0;     ///< of two spheres [d]
  double contacts_per_grain = 0;  ///< contacts of a grain with grains and wall grains
  double wall_imbalance = 0;      ///< (load - contact force on the moving wall) / (P A_w)
};

/// With P = 0 the imbalance is relative to k d^2.
Diagnostics diagnose(const Cell& cell, const Scene& scene, const State& state,
                     const WallPose& pose);

}  // namespace shearcell
