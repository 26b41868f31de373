// SPDX-License-Identifier: GPL-3.0-or-later
// Volume fractions, overlaps of grains, and distances of grains from the walls. Supplement B.2.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell.hpp"

namespace shearcell {

/// Mean distance from a rough wall's plane to the inner surface of the wall grains [d]. The
/// centres of the wall grains lie 0 to d/4 behind the plane.
inline constexpr double rough_wall_surface = 0.375;
/// Interior grains are at least this far from the wall surfaces [d]. Supplement C.
inline constexpr double interior_distance = 1.5;
/// Core grains are at least this far from the wall surfaces [d]. Closer to rough walls, phi is
/// lower, and hardly any crystallite nucleates (experiments/results/README.md). [choice]
inline constexpr double core_distance = 4;
/// Distance from each wall plane to the wall surface, towards the interior of the cell [d].
inline double wall_surface(const Cell& cell) {
  return cell.wall_grains.empty() ? 0.0 : rough_wall_surface;
}
/// Minimum distance of interior grains from the wall planes [d].
inline double interior_margin(const Cell& cell) {
  return interior_distance + wall_surface(cell);
}

/// Overlaps delta = 1 - r_ij of a grain with another grain or with a wall grain. Contacts with wall
/// planes do not count.
struct Overlaps {
  std::vector<double> largest;         ///< delta_max,i [d], 0 for a grain without contact
  std::vector<std::int32_t> contacts;  ///< contacts of each grain, including those with wall grains
  double mean = 0;  ///< mean overlap of touching pairs of grains (Eq. S3) [d]; 0 without pairs
};

/// Computes the overlaps of `grains` (3 x n [d], z unwrapped).
Overlaps overlaps(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains);

/// Distance [d] of each grain's centre from the nearest of the four wall surfaces, measured along
/// the normal of the wall. Without wall grains in the cell, the surface is the wall plane. With
/// wall grains, the surface is this plane, moved by `rough_wall_surface` towards the interior.
std::vector<double> distances_from_walls(const Cell& cell, const WallPose& pose,
                                         const Eigen::Matrix3Xd& grains);

/// 1 for grains at least `least` [d] from the wall surfaces, else 0.
std::vector<std::uint8_t> interior_grains(const Cell& cell, const WallPose& pose,
                                          const Eigen::Matrix3Xd& grains,
                                          double least = interior_distance);

/// The region in which the centres of interior grains lie. The borders of the region are parallel
/// to the walls; in z it is periodic.
struct InteriorRegion {
  double left = 0;    ///< x of the left border at y = bottom [d]
  double bottom = 0;  ///< y of the lower border [d]
  double width = 0;   ///< in x [d]
  double height = 0;  ///< [d]
  double depth = 0;   ///< period [d]
  double tan_theta = 0;

  double volume() const { return width * height * depth; }
};
/// If the cell is too small for interior grains, the region has a negative width or height.
InteriorRegion interior_region(const Cell& cell, const WallPose& pose);

/// phi_local of one grain: Eq. S4 for this grain alone, (pi/6) (1 - delta_max)^3 / V_cell.
double local_packing_fraction(double largest_overlap, double cell_volume);

struct PackingFractions {
  double phi;              ///< Eq. S4; NaN if no grain is selected
  double phi_uncorrected;  ///< phi_u, Eq. S2; NaN if no grain is selected
};

/// Volume fractions of the grains with selected[i] != 0. All spans have one entry per grain.
PackingFractions packing_fractions(std::span<const double> largest_overlap,
                                   std::span<const double> cell_volume,
                                   std::span<const std::uint8_t> selected);

}  // namespace shearcell
