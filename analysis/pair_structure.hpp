// SPDX-License-Identifier: GPL-3.0-or-later
// Region and bins for g(r) and S(k) of interior grains.
#pragma once

#include "core/cell.hpp"

namespace shearcell {

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

inline constexpr double pair_bin_d = 0.02;        ///< width of the bins in r [d]
inline constexpr double pair_reach_d = 5;         ///< largest r; at most half the depth [d]
inline constexpr double wave_bin_per_d = 0.25;    ///< width of the bins in |k| [1/d]
inline constexpr double largest_wave_per_d = 25;  ///< largest |k| [1/d]

}  // namespace shearcell
