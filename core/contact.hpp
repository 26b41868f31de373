// SPDX-License-Identifier: GPL-3.0-or-later
// The contact law: a linear repulsive spring between two spheres of diameter d = 1.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace shearcell {

/// Grain j acts on grain i with the force k (1 - r) n = k (1/r - 1) dr, where dr = r_i - r_j. The
/// factor (1/r - 1) depends only on s = 1 - r^2. For s <= kSeriesEnd (overlaps up to 1.6 % of d)
/// the factor is s times this polynomial, a Chebyshev fit of ((1 - s)^(-1/2) - 1) / s on [0, 1/32]
/// with a relative error below 1.6e-15. The polynomial takes a fifth of the time of an IEEE square
/// root and division. A polynomial of one degree more has an error of 4e-16 and is 7 % slower.
/// Fused multiply-adds in a fixed order give the same bits on every machine.
inline constexpr std::array<double, 7> kContactSeries = {
    0x1.0000000000007p-1, 0x1.7ffffffff5521p-2, 0x1.40000015536bcp-2, 0x1.17fff00e04b40p-2,
    0x1.f80b53f5bc39cp-3, 0x1.cbf1852eaae8cp-3, 0x1.dbe4440991bcbp-3};
inline constexpr double kSeriesEnd = 0.03125;

/// Returns 1/r - 1 for s = 1 - r^2 in (0, 1], and 0 for s <= 0. The result is infinite for s = 1
/// (coincident centres). The SIMD kernel performs the same operations.
inline double contact_factor(double s) {
  if (s > kSeriesEnd) return 1.0 / std::sqrt(1.0 - s) - 1.0;
  s = std::max(0.0, s);  // faster than a branch, which would be mispredicted
  double series = kContactSeries.back();
  for (std::size_t n = kContactSeries.size() - 1; n-- > 0;) {
    series = std::fma(series, s, kContactSeries[n]);
  }
  return s * series;
}

/// 1 - r^2, where r is the distance between two grains. It is positive if the grains touch.
inline double one_minus_square(double dx, double dy, double dz) {
  return std::fma(-dz, dz, std::fma(-dy, dy, std::fma(-dx, dx, 1.0)));
}

/// Reduces any difference `dz` in z to the difference from the nearest periodic image [d].
inline double nearest_image(double dz, double depth, double per_depth) {
  return std::fma(-std::nearbyint(dz * per_depth), depth, dz);
}

}  // namespace shearcell
