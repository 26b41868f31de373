// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/trigonometry.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace shearcell {
namespace {

// Number of Taylor terms after the first term. At pi/2 the last term is below 1e-19.
constexpr int kTerms = 12;

// Computes 1 - x^2 / (a (a + 1)) (1 - x^2 / ((a + 2) (a + 3)) (1 - ...)). This is cos(x) for a = 1
// and sin(x) / x for a = 2.
double series(double x, int a) {
  double sum = 1.0;
  for (int m = a + 2 * (kTerms - 1); m >= a; m -= 2) {
    sum = std::fma(-(x * x) / static_cast<double>(m * (m + 1)), sum, 1.0);
  }
  return sum;
}

SineCosine sine_cosine_series(double x) {
  return {x * series(x, 2), series(x, 1)};
}

}  // namespace

SineCosine sine_cosine(double angle) {
  if (!(std::fabs(angle) <= std::numbers::pi / 2)) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan};
  }
  return sine_cosine_series(angle);
}

SineCosine turn_sine_cosine(std::uint64_t step, std::uint64_t period) {
  // Integer arithmetic finds the octant, so the error does not grow with the step count.
  const std::uint64_t quarters = 4 * (step % period);
  const std::uint64_t quadrant = quarters / period;
  const std::uint64_t rest = quarters % period;
  const bool folded = 2 * rest > period;
  const double part = static_cast<double>(folded ? period - rest : rest);
  const double x = std::numbers::pi / 2 * (part / static_cast<double>(period));
  SineCosine sc = sine_cosine_series(x);
  if (folded) sc = {sc.cosine, sc.sine};
  switch (quadrant) {
    case 1:
      return {sc.cosine, -sc.sine};
    case 2:
      return {-sc.sine, -sc.cosine};
    case 3:
      return {-sc.cosine, sc.sine};
    default:
      return sc;
  }
}

}  // namespace shearcell
