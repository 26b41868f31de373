// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/trigonometry.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace shearcell {
namespace {

// Factorials up to 25: the last Taylor term at pi/2 is below 1e-20.
constexpr int kTerms = 12;

double sine_series(double x) {
  const double x2 = x * x;
  double sum = 1.0;
  for (int n = kTerms; n >= 1; --n) {
    sum = std::fma(-x2 / static_cast<double>((2 * n) * (2 * n + 1)), sum, 1.0);
  }
  return x * sum;
}

double cosine_series(double x) {
  const double x2 = x * x;
  double sum = 1.0;
  for (int n = kTerms; n >= 1; --n) {
    sum = std::fma(-x2 / static_cast<double>((2 * n - 1) * (2 * n)), sum, 1.0);
  }
  return sum;
}

}  // namespace

SineCosine sine_cosine(double angle) {
  if (!(std::fabs(angle) <= std::numbers::pi / 2)) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan};
  }
  return {sine_series(angle), cosine_series(angle)};
}

SineCosine turn_sine_cosine(std::uint64_t step, std::uint64_t period) {
  // Integer arithmetic finds the octant, so the error does not grow with the step count.
  const std::uint64_t quarters = 4 * (step % period);
  const std::uint64_t quadrant = quarters / period;
  const std::uint64_t rest = quarters % period;
  const bool folded = 2 * rest > period;
  const double part = static_cast<double>(folded ? period - rest : rest);
  const double x = std::numbers::pi / 2 * (part / static_cast<double>(period));
  SineCosine sc{sine_series(x), cosine_series(x)};
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
