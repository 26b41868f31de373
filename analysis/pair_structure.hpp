// SPDX-License-Identifier: GPL-3.0-or-later
// g(r) and S(k) of interior grains, at the middles of equal bins; not a number where nothing was
// counted.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "analysis/measures.hpp"

namespace shearcell {

/// The region of the centres of interior grains: between planes parallel to the walls, periodic in
/// z.
struct InteriorRegion {
  double left = 0;    ///< x of the left border at y = bottom [d]
  double bottom = 0;  ///< [d]
  double width = 0;   ///< in x [d]
  double height = 0;  ///< [d]
  double depth = 0;   ///< period [d]
  double tan_theta = 0;

  double volume() const { return width * height * depth; }
};
/// Width or height of the result are negative if the cell is too small for interior grains.
InteriorRegion interior_region(const Cell& cell, const WallPose& pose);

inline constexpr double pair_bin_d = 0.02;  ///< [d]
inline constexpr double pair_reach_d = 5;   ///< largest r, or half the depth if that is less [d]
inline constexpr double wave_bin_per_d = 0.25;    ///< [1/d]
inline constexpr double largest_wave_per_d = 25;  ///< [1/d]

/// Pair correlation of the interior grains: the number of pairs at a distance r over the expected
/// number for as many grains placed at random in the same region. The expected number follows
/// exactly from the set covariance of the region, a parallelepiped (Ohser, Math. Operationsforsch.
/// Statist. 14, 63 (1983)).
MeasuredCurve pair_correlation(const Cell& cell, const WallPose& pose,
                               const Eigen::Matrix3Xd& grains,
                               std::span<const std::uint8_t> interior);

/// Structure factor of the interior grains, |sum exp(i k r)|^2 / n, as a mean over wave vectors of
/// the region's reciprocal lattice, for which a uniform density gives zero. Each bin in |k| takes
/// at most 48 vectors, evenly spaced in their lexical order.
MeasuredCurve structure_factor(const Cell& cell, const WallPose& pose,
                               const Eigen::Matrix3Xd& grains,
                               std::span<const std::uint8_t> interior);

}  // namespace shearcell
