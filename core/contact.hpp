// SPDX-License-Identifier: GPL-3.0-or-later
// The contact law: a linear repulsive spring between spheres of diameter 1 (d).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace shearcell {

/// The force of grain j on grain i is k (1 - r) n = k (1/r - 1) dr with dr = r_i - r_j. The factor
/// (1/r - 1) is a function of s = 1 - r^2 alone. Below `kSeriesEnd` (an overlap of 2.4 % of d) it
/// is s times this polynomial, Chebyshev's fit of ((1 - s)^(-1/2) - 1) / s on [0, 3/64], whose
/// relative error is below 4e-16; that costs a quarter of an IEEE square root and division. Fused
/// multiply-adds in a fixed order make it the same number on every machine.
inline constexpr std::array<double, 8> kContactSeries = {
    0x1.ffffffffffffdp-2, 0x1.8000000001e61p-2, 0x1.3ffffffcaee3ap-2, 0x1.180002341faa0p-2,
    0x1.f7fe90c23dc82p-3, 0x1.ce40ab1a4211ap-3, 0x1.a6bcab0ea0c35p-3, 0x1.e19bcd23e162bp-3};
inline constexpr double kSeriesEnd = 0.046875;

/// (1/r - 1) for s = 1 - r^2 in (0, 1]; infinite for coincident centres. The vector kernel
/// evaluates the same operations: even and odd powers by Horner's rule in s^2, then their sum.
inline double contact_factor(double s) {
  if (s > kSeriesEnd) return 1.0 / std::sqrt(1.0 - s) - 1.0;
  const double s2 = s * s;
  const auto& c = kContactSeries;
  double odd = c[7];
  double even = c[6];
  for (std::size_t n = 4;; n -= 2) {
    odd = std::fma(odd, s2, c[n + 1]);
    even = std::fma(even, s2, c[n]);
    if (n == 0) break;
  }
  return s * std::fma(odd, s, even);
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
