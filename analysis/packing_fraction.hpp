// SPDX-License-Identifier: GPL-3.0-or-later
// How densely the grains are packed, and how far soft grains overlap. Supplement B.2.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell.hpp"

namespace shearcell {

/// Mean inner surface of a rough wall's grains, inside its plane [d]: centres lie 0 to d/4 behind.
inline constexpr double rough_wall_surface = 0.375;
/// Interior grains are at least this far from the wall surfaces [d]. Supplement C.
inline constexpr double interior_distance = 1.5;
/// Core grains are at least this far from the wall surfaces [d]. Closer to rough walls phi is lower
/// and hardly any crystallite nucleates (experiments/results/README.md). [choice]
inline constexpr double core_distance = 4;
/// How far the surface of the walls lies inside their planes [d].
inline double wall_surface(const Cell& cell) {
  return cell.wall_grains.empty() ? 0.0 : rough_wall_surface;
}
/// The least distance of interior grains from the planes of the walls [d].
inline double interior_margin(const Cell& cell) {
  return interior_distance + wall_surface(cell);
}

/// Overlaps delta = 1 - r_ij of grains with grains and wall grains; the plane behind a wall has no
/// r_ij and does not count.
struct Overlaps {
  std::vector<double> largest;         ///< delta_max,i [d], 0 for a grain without contact
  std::vector<std::int32_t> contacts;  ///< of each grain, with grains and wall grains
  double mean = 0;  ///< Eq. S3 over distinct pairs of grains [d]; 0 without pairs
};

/// Contacts of `grains` (3 x n [d], z unwrapped).
Overlaps overlaps(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains);

/// Distance of each grain's centre from the nearest wall surface in x and y [d], from a tilted wall
/// along its normal. The surface is `rough_wall_surface` inside the plane when the cell has wall
/// grains, else the plane itself.
std::vector<double> distances_from_walls(const Cell& cell, const WallPose& pose,
                                         const Eigen::Matrix3Xd& grains);

/// 1 for grains at least `interior_distance` from the walls.
std::vector<std::uint8_t> interior_grains(const Cell& cell, const WallPose& pose,
                                          const Eigen::Matrix3Xd& grains);

/// phi_local of one grain: Eq. S4 without its sums, (pi/6) (1 - delta_max)^3 / V_cell.
double local_packing_fraction(double largest_overlap, double cell_volume);

struct PackingFractions {
  double phi;              ///< Eq. S4; not a number when no grain is selected
  double phi_uncorrected;  ///< phi_u, Eq. S2; not a number when no grain is selected
};

/// Global fractions over the grains with `selected[i] != 0`. All spans have one entry per grain.
PackingFractions packing_fractions(std::span<const double> largest_overlap,
                                   std::span<const double> cell_volume,
                                   std::span<const std::uint8_t> selected);

}  // namespace shearcell
