// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "core/random.hpp"

namespace shearcell {
namespace {

constexpr std::size_t bootstrap_selections = 1000;
constexpr double upper = (1 + confidence_level) / 2;

Interval around(double value, double error, double freedom) {
  const double half = error > 0 ? student_quantile(upper, freedom) * error : 0;
  return {value - half, value + half};
}

/// Values over all selections; those without one are left out.
std::vector<double> bootstrap_values(std::size_t runs, const RunStatistic& statistic) {
  std::vector<std::size_t> selection(runs);
  std::vector<double> values;
  for (std::uint32_t s = 0; s < bootstrap_selections; ++s) {
    for (std::size_t k = 0; k < runs; ++k) {
      const double u = uniform_pair({s, static_cast<std::uint32_t>(k), 0, 0}, 0)[0];
      selection[k] = static_cast<std::size_t>(u * static_cast<double>(runs));
    }
    const std::optional<double> value = statistic(selection);
    if (value && !std::isnan(*value)) values.push_back(*value);
  }
  return values;
}

}  // namespace

RunStatistics over_runs(std::span<const double> values) {
  RunStatistics result;
  double sum = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++result.runs;
  }
  if (result.runs == 0) return result;
  const auto n = static_cast<double>(result.runs);
  const double mean = sum / n;
  result.mean = mean;
  if (result.runs < 2) return result;
  double squares = 0;
  for (const double value : values) {
    if (std::isfinite(value)) squares += (value - mean) * (value - mean);
  }
  result.standard_error = std::sqrt(squares / (n * (n - 1)));
  return result;
}

std::optional<double> bootstrap_error(std::size_t runs, const RunStatistic& statistic) {
  if (runs < 2) return std::nullopt;
  const RunStatistics found = over_runs(bootstrap_values(runs, statistic));
  if (found.runs < bootstrap_selections / 2) return std::nullopt;
  const auto n = static_cast<double>(runs);
  return found.standard_error.value() * std::sqrt(static_cast<double>(found.runs) * n / (n - 1));
}

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
  return Estimate{.value = *found.mean,
                  .interval = around(*found.mean, *found.standard_error, n - 1),
                  .runs = found.runs,
                  .spread = *found.standard_error * std::sqrt(n)};
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
  const double difference = *x.mean - *y.mean;
  return Estimate{.value = difference,
                  .interval = around(difference, std::sqrt(xx + yy), freedom),
                  .runs = std::min(x.runs, y.runs),
                  .groups = 2,
                  .spread = std::sqrt(n * xx + m * yy)};
}

std::optional<Estimate> bootstrapped(std::size_t runs, const RunStatistic& statistic) {
  if (runs < least_runs) return std::nullopt;
  std::vector<std::size_t> every(runs);
  std::iota(every.begin(), every.end(), std::size_t{0});
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
  const double low = out < missing ? -infinite : values[out - missing];
  const double high = values[bootstrap_selections - 1 - out];
  return Estimate{.value = *value,
                  .interval = {low, high},
                  .runs = runs,
                  .spread = (high - low) / (2 * t) * std::sqrt(n)};
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
