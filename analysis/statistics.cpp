// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <set>

#include "core/random.hpp"

namespace shearcell {
namespace {

constexpr std::size_t bootstrap_selections = 1000;

double upper(double level = confidence_level) {
  return (1 + level) / 2;
}

Interval around(double value, double error, double freedom, double level) {
  const double half = error > 0 ? student_quantile(upper(level), freedom) * error : 0;
  return {value - half, value + half};
}

/// Draws samples with `chosen` runs. Returns the statistic of each sample; NaN is left out.
std::vector<double> bootstrap_values(std::size_t runs, std::size_t chosen,
                                     const RunStatistic& statistic) {
  std::vector<std::size_t> selection(chosen);
  std::vector<double> values;
  for (std::uint32_t s = 0; s < bootstrap_selections; ++s) {
    for (std::size_t k = 0; k < chosen; ++k) {
      const double u = uniform_pair({s, static_cast<std::uint32_t>(k), 0, 0}, 0)[0];
      selection[k] = static_cast<std::size_t>(u * static_cast<double>(runs));
    }
    const double value = statistic(selection);
    if (!std::isnan(value)) values.push_back(value);
  }
  return values;
}

/// The range of the bootstrap values after removing the fraction `tail` of them at each end. For
/// the lower end, a missing value (NaN) counts as -infinity; for the upper end, as +infinity.
Interval percentiles(std::vector<double> values, double tail) {
  const std::size_t missing = bootstrap_selections - values.size();
  values.insert(values.end(), missing, infinite);
  std::sort(values.begin(), values.end());
  const auto out = static_cast<std::size_t>(tail * static_cast<double>(bootstrap_selections));
  return {out < missing ? -infinite : values[out - missing],
          values[bootstrap_selections - 1 - out]};
}

/// Number of runs observed without an event until `cycle`, and number of events at `cycle`.
struct AtRisk {
  double waiting = 0;
  double events = 0;
};
AtRisk at(std::span<const CensoredValue> runs, double cycle) {
  AtRisk found;
  for (const CensoredValue& run : runs) {
    if (run.value >= cycle) ++found.waiting;
    if (!run.censored && run.value == cycle) ++found.events;
  }
  return found;
}

std::set<double> event_cycles(std::span<const CensoredValue> runs) {
  std::set<double> cycles;
  for (const CensoredValue& run : runs) {
    if (!run.censored) cycles.insert(run.value);
  }
  return cycles;
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

RunStatistics rms_over_runs(std::span<const double> values) {
  std::vector<double> squares;
  for (const double value : values) squares.push_back(value * value);
  RunStatistics result = over_runs(squares);
  if (!result.mean) return result;
  const double root = std::sqrt(*result.mean);
  result.mean = root;
  if (result.standard_error && root > 0) *result.standard_error /= 2 * root;
  return result;
}

double least_squares_slope(std::span<const std::pair<double, double>> points) {
  const auto n = static_cast<double>(points.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [at, value] : points) {
    x += at;
    y += value;
  }
  for (const auto& [at, value] : points) {
    xx += (at - x / n) * (at - x / n);
    xy += (at - x / n) * (value - y / n);
  }
  return xy / xx;
}

RunStatistic mean_of_items(std::span<const std::vector<double>> groups) {
  std::vector<double> sums;
  std::vector<std::size_t> sizes;
  for (const std::vector<double>& items : groups) {
    sums.push_back(std::accumulate(items.begin(), items.end(), 0.0));
    sizes.push_back(items.size());
  }
  return [sums, sizes](std::span<const std::size_t> selection) {
    double sum = 0;
    std::size_t all = 0;
    for (const std::size_t group : selection) {
      sum += sums[group];
      all += sizes[group];
    }
    return sum / static_cast<double>(all);
  };
}

std::optional<double> bootstrap_error(std::size_t runs, const RunStatistic& statistic) {
  if (runs < 2) return std::nullopt;
  const RunStatistics found = over_runs(bootstrap_values(runs, runs, statistic));
  if (found.runs < bootstrap_selections / 2) return std::nullopt;
  const auto n = static_cast<double>(runs);
  return found.standard_error.value() * std::sqrt(static_cast<double>(found.runs) * n / (n - 1));
}

Estimate estimate_with(double value, const Interval& interval, double quantile, std::size_t runs) {
  const double error = (interval.high - interval.low) / (2 * quantile);
  return {.value = value,
          .interval = interval,
          .runs = runs,
          .spread = error * std::sqrt(static_cast<double>(runs))};
}

Estimate mapped(Estimate estimate, const std::function<double(double)>& increasing) {
  estimate.value = increasing(estimate.value);
  estimate.interval = {increasing(estimate.interval.low), increasing(estimate.interval.high)};
  return estimate;
}

double student_quantile(double probability, double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), probability);
}

double normal_quantile(double probability) {
  return boost::math::quantile(boost::math::normal(), probability);
}

std::optional<Estimate> mean_of(std::span<const double> values, double level) {
  const RunStatistics found = over_runs(values);
  if (found.runs < least_runs) return std::nullopt;
  const auto n = static_cast<double>(found.runs);
  return Estimate{.value = *found.mean,
                  .interval = around(*found.mean, *found.standard_error, n - 1, level),
                  .runs = found.runs,
                  .spread = *found.standard_error * std::sqrt(n)};
}

std::optional<Estimate> difference_of_means(std::span<const double> a, std::span<const double> b,
                                            double level) {
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
                  .interval = around(difference, std::sqrt(xx + yy), freedom, level),
                  .runs = std::min(x.runs, y.runs),
                  .groups = 2,
                  .spread = std::sqrt(n * xx + m * yy)};
}

std::optional<Estimate> bootstrapped(std::size_t runs, const RunStatistic& statistic,
                                     double level) {
  if (runs < least_bootstrap_runs) return std::nullopt;
  std::vector<std::size_t> every(runs);
  std::iota(every.begin(), every.end(), std::size_t{0});
  const double value = statistic(every);
  if (!std::isfinite(value)) return std::nullopt;
  const auto n = static_cast<double>(runs);
  const double t = student_quantile(upper(level), n - 1);
  const double tail = boost::math::cdf(boost::math::normal(), -t * std::sqrt(n / (n - 1)));
  return estimate_with(value, percentiles(bootstrap_values(runs, runs, statistic), tail), t, runs);
}

Interval repetitions(std::size_t runs, std::size_t chosen, const RunStatistic& statistic) {
  if (runs < least_bootstrap_runs) return {-infinite, infinite};
  return percentiles(bootstrap_values(runs, chosen, statistic), 1 - upper());
}

std::optional<SpreadBetween> variance_between(std::span<const std::vector<double>> groups,
                                              double level) {
  double n = 0, k = 0, sum = 0, sum_of_squares = 0, sizes = 0, within = 0;
  for (const std::vector<double>& group : groups) {
    const RunStatistics found = over_runs(group);
    if (found.runs == 0) continue;
    const double size = static_cast<double>(found.runs), mean = *found.mean;
    k += 1;
    n += size;
    sizes += size * size;
    sum += size * mean;
    sum_of_squares += size * mean * mean;
    within += std::pow(found.standard_error.value_or(0), 2) * size * (size - 1);
  }
  if (k < 2 || n == k) return std::nullopt;
  const double tail = (1 - level) / 2;
  const double size = (n - sizes / n) / (k - 1);
  const double between = (sum_of_squares - sum * sum / n) / (k - 1), noise = within / (n - k);
  const double least = boost::math::quantile(boost::math::fisher_f(k - 1, n - k), tail);
  const double chi = boost::math::quantile(boost::math::chi_squared(k - 1), tail);
  const auto root = [size](double variance) { return std::sqrt(std::max(0.0, variance) / size); };
  return SpreadBetween{root(between - noise), root((between - least * noise) * (k - 1) / chi),
                       between / noise};
}

std::optional<Estimate> relative_difference(const std::optional<Estimate>& a,
                                            const std::optional<Estimate>& b) {
  if (!a || !b) return std::nullopt;
  const auto log_factor = [](double high, double low) {  // infinite if low is not positive
    return std::log(std::max(high, 0.0) / std::max(low, 0.0));
  };
  const double value = a->value / b->value;
  const double down =
      std::hypot(log_factor(a->value, a->interval.low), log_factor(b->interval.high, b->value));
  const double up =
      std::hypot(log_factor(a->interval.high, a->value), log_factor(b->value, b->interval.low));
  return Estimate{.value = value - 1,
                  .interval = {value * std::exp(-down) - 1, value * std::exp(up) - 1},
                  .runs = std::min(a->runs, b->runs),
                  .groups = 2,
                  .spread = value * std::hypot(a->spread / a->value, b->spread / b->value)};
}

std::optional<std::size_t> runs_to_resolve(const Estimate& estimate, double distance,
                                           bool both_sides) {
  constexpr std::size_t most = 10000;
  constexpr double power = 0.9;
  const double hit = both_sides ? (1 + power) / 2 : power;
  const double ratio = estimate.spread / distance;
  // Student's quantiles exceed normal quantiles, so normal quantiles give a lower limit for n.
  const double least = std::pow((normal_quantile(upper()) + normal_quantile(hit)) * ratio, 2);
  if (!(least <= most)) return std::nullopt;
  for (auto n = std::max(least_runs, static_cast<std::size_t>(least)); n <= most; ++n) {
    const auto freedom = static_cast<double>(estimate.groups * (n - 1));
    const double needed = student_quantile(upper(), freedom) + student_quantile(hit, freedom);
    if (needed * ratio <= std::sqrt(static_cast<double>(n))) return n;
  }
  return std::nullopt;
}

std::vector<SurvivalStep> kaplan_meier(std::span<const CensoredValue> runs) {
  std::vector<SurvivalStep> steps;
  double survival = 1;
  for (const double cycle : event_cycles(runs)) {
    const AtRisk risk = at(runs, cycle);
    survival *= 1 - risk.events / risk.waiting;
    steps.push_back({cycle, survival});
  }
  return steps;
}

std::optional<double> median_wait(std::span<const CensoredValue> runs) {
  constexpr double rounding = 1e-12;
  const std::vector<SurvivalStep> steps = kaplan_meier(runs);
  const auto reached = std::ranges::find_if(
      steps, [](const SurvivalStep& step) { return step.survival <= 0.5 + rounding; });
  if (reached == steps.end()) return std::nullopt;
  const auto next = std::next(reached);
  const bool half = reached->survival > 0.5 - rounding && next != steps.end();
  return half ? (reached->cycle + next->cycle) / 2 : reached->cycle;
}

double log_rank(std::span<const CensoredValue> a, std::span<const CensoredValue> b) {
  std::set<double> cycles = event_cycles(a);
  cycles.merge(event_cycles(b));
  double excess = 0;
  double variance = 0;
  for (const double cycle : cycles) {
    const AtRisk x = at(a, cycle);
    const AtRisk y = at(b, cycle);
    const double waiting = x.waiting + y.waiting;
    const double events = x.events + y.events;
    excess += x.events - events * x.waiting / waiting;
    if (waiting > 1) {
      variance +=
          events * (waiting - events) * x.waiting * y.waiting / (waiting * waiting * (waiting - 1));
    }
  }
  return variance > 0 ? excess / std::sqrt(variance) : 0;
}

std::optional<Estimate> log2_wait_ratio(std::span<const CensoredValue> a,
                                        std::span<const CensoredValue> b, double level) {
  if (std::min(a.size(), b.size()) < least_runs) return std::nullopt;
  if (event_cycles(a).empty() && event_cycles(b).empty()) return std::nullopt;
  std::set<double> factors;  // log2 of the ratio of each time in `a` to each time in `b`
  for (const CensoredValue& x : a) {
    for (const CensoredValue& y : b) {
      if (x.value > 0 && y.value > 0) factors.insert(std::log2(x.value / y.value));
    }
  }
  if (factors.empty()) return std::nullopt;
  const std::vector<double> edges(factors.begin(), factors.end());
  const double limit = student_quantile(upper(level), static_cast<double>(a.size() + b.size() - 2));
  std::vector<CensoredValue> scaled(b.begin(), b.end());
  double negative = edges.front();  // largest factor at which log_rank() < 0
  double positive = edges.back();   // smallest factor at which log_rank() > 0
  Interval kept{infinite, -infinite};
  // Each interval: before the first edge, between two edges, and after the last edge.
  for (std::size_t k = 0; k <= edges.size(); ++k) {
    const double low = k == 0 ? -infinite : edges[k - 1];
    const double high = k == edges.size() ? infinite : edges[k];
    const double factor = k == 0 ? high - 1 : k == edges.size() ? low + 1 : (low + high) / 2;
    for (std::size_t j = 0; j < b.size(); ++j) scaled[j].value = b[j].value * std::exp2(factor);
    const double z = log_rank(a, scaled);
    if (std::abs(z) < limit) kept = {std::min(kept.low, low), std::max(kept.high, high)};
    if (z < 0 && k < edges.size()) negative = high;
    if (z > 0 && k > 0) positive = std::min(positive, low);
  }
  double value = (negative + positive) / 2;
  // If one group has no event, only a bound of the ratio of the waiting times is known.
  if (event_cycles(a).empty()) value = infinite;
  if (event_cycles(b).empty()) value = -infinite;
  kept = {std::min(kept.low, value), std::max(kept.high, value)};
  Estimate estimate = estimate_with(value, kept, limit, std::min(a.size(), b.size()));
  estimate.groups = 2;
  return estimate;
}

}  // namespace shearcell
