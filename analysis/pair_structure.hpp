// SPDX-License-Identifier: GPL-3.0-or-later
// What g(r) and S(k) of interior grains are computed over.
#pragma once

#include "core/cell.hpp"

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
/// The region has a negative width or height if the cell is too small for interior grains.
InteriorRegion interior_region(const Cell& cell, const WallPose& pose);

inline constexpr double pair_bin_d = 0.02;        ///< [d]
inline constexpr double pair_reach_d = 5;         ///< largest r; at most half the depth [d]
inline constexpr double wave_bin_per_d = 0.25;    ///< [1/d]
inline constexpr double largest_wave_per_d = 25;  ///< [1/d]

}  // namespace shearcell
