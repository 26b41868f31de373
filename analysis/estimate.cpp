// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/estimate.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace shearcell {
namespace {

constexpr double upper = (1 + confidence_level) / 2;

Estimate symmetric(double value, double error, double freedom) {
  const double half = error > 0 ? student_quantile(upper, freedom) * error : 0;
  Estimate estimate;
  estimate.value = value;
  estimate.interval = {value - half, value + half};
  return estimate;
}

}  // namespace

double student_quantile(double probability, double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), probability);
}

double normal_quantile(double probability) {
  return boost::math::quantile(boost::math::normal(), probability);
}

std::optional<Estimate> mean_of(std::span<const double> values) {
  const RunStatistics found = over_runs(values);
  if (found.runs < least_runs) return std::nullopt;
  const auto n = static_cast<double>(found.runs);
  Estimate estimate = symmetric(*found.mean, *found.standard_error, n - 1);
  estimate.runs = found.runs;
  estimate.spread = *found.standard_error * std::sqrt(n);
  return estimate;
}

std::optional<Estimate> difference_of_means(std::span<const double> a, std::span<const double> b) {
  const RunStatistics x = over_runs(a);
  const RunStatistics y = over_runs(b);
  if (std::min(x.runs, y.runs) < least_runs) return std::nullopt;
  const double xx = *x.standard_error * *x.standard_error;
  const double yy = *y.standard_error * *y.standard_error;
  const auto n = static_cast<double>(x.runs);
  const auto m = static_cast<double>(y.runs);
  const double freedom = (xx + yy) * (xx + yy) / (xx * xx / (n - 1) + yy * yy / (m - 1));
  Estimate estimate = symmetric(*x.mean - *y.mean, std::sqrt(xx + yy), freedom);
  estimate.runs = std::min(x.runs, y.runs);
  estimate.groups = 2;
  estimate.spread = std::sqrt(n * xx + m * yy);
  return estimate;
}

std::optional<Estimate> bootstrapped(std::size_t runs, const RunStatistic& statistic) {
  if (runs < least_runs) return std::nullopt;
  std::vector<std::size_t> every(runs);
  for (std::size_t run = 0; run < runs; ++run) every[run] = run;
  const std::optional<double> value = statistic(every);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  std::vector<double> values = bootstrap_values(runs, statistic);
  const std::size_t missing = bootstrap_selections - values.size();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  values.insert(values.end(), missing, infinite);
  std::sort(values.begin(), values.end());

  const auto n = static_cast<double>(runs);
  const double t = student_quantile(upper, n - 1);
  const double tail = boost::math::cdf(boost::math::normal(), -t * std::sqrt(n / (n - 1)));
  const auto out = static_cast<std::size_t>(tail * static_cast<double>(bootstrap_selections));
  Estimate estimate;
  estimate.value = *value;
  estimate.interval = {out < missing ? -infinite : values[out - missing],
                       values[bootstrap_selections - 1 - out]};
  estimate.runs = runs;
  estimate.spread = (estimate.interval.high - estimate.interval.low) / (2 * t) * std::sqrt(n);
  return estimate;
}

std::optional<std::size_t> runs_to_resolve(const Estimate& estimate, double distance,
                                           bool both_sides) {
  constexpr std::size_t most = 10000;
  constexpr double power = 0.9;
  const double hit = both_sides ? (1 + power) / 2 : power;
  const double ratio = estimate.spread / distance;
  // Student's quantiles exceed the normal ones, so no smaller number is enough.
  const double least = std::pow((normal_quantile(upper) + normal_quantile(hit)) * ratio, 2);
  if (!(least <= most)) return std::nullopt;
  for (auto n = std::max(least_runs, static_cast<std::size_t>(least)); n <= most; ++n) {
    const auto freedom = static_cast<double>(estimate.groups * (n - 1));
    const double needed = student_quantile(upper, freedom) + student_quantile(hit, freedom);
    if (needed * ratio <= std::sqrt(static_cast<double>(n))) return n;
  }
  return std::nullopt;
}

}  // namespace shearcell
