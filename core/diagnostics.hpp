// SPDX-License-Identifier: GPL-3.0-or-later
// Observables that a run records with each state, computed without neighbour lists.
#pragma once

#include <cstdint>
#include <functional>

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

/// One contact of a grain. `other` is the id of a grain (kind grain), an index of Cell::wall_grains
/// (kind wall_grain), or a WallSide (kind wall_plane).
struct Contact {
  enum class Kind : std::uint8_t { grain, wall_grain, wall_plane };
  Kind kind;
  std::int32_t grain;
  std::int32_t other;
  WallSide side;           ///< wall that the grain touches; unused if `kind` is grain
  double overlap;          ///< [d]
  Eigen::Vector3d normal;  ///< unit vector towards `grain`
};

/// Calls visit(contact) for every contact of `grains` (3 x N positions [d], z unwrapped), in
/// ascending order of Contact::grain. A pair of grains is visited once, with grain < other.
void for_each_contact(const Cell& cell, const Eigen::Matrix3Xd& grains, const WallPose& pose,
                      const std::function<void(const Contact&)>& visit);

/// Unit of the force tolerances [m d/s^2]: P d^2; without pressure, the larger of m g and 1.
double force_unit(const Scene& scene);

struct Diagnostics {
  double kinetic_energy = 0;      ///< mean per grain, from half-step velocities [m d^2/s^2]
  double mean_overlap = 0;        ///< mean over touching pairs of grains, Eq. S3 [d]
  double largest_overlap = 0;     ///< largest overlap of two spheres [d]
  double contacts_per_grain = 0;  ///< mean number of contacts with grains and wall grains
  double wall_imbalance = 0;      ///< (load - contact force on the moving wall) / (P A_w)
};

/// Computes the diagnostics of a state. Without pressure, wall_imbalance is relative to k d.
Diagnostics diagnose(const Cell& cell, const Scene& scene, const State& state,
                     const WallPose& pose);

}  // namespace shearcell
