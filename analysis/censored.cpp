// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/censored.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

namespace shearcell {
namespace {

using CensoredValues = std::span<const CensoredValue>;

/// Hazard of the standard normal distribution: the density at z divided by the probability of a
/// value above z.
double normal_hazard(double z) {
  if (z > 25) return z + 1 / z - 2 / (z * z * z);  // std::erfc underflows near z = 38
  return std::sqrt(2 / std::numbers::pi) * std::exp(-z * z / 2) / std::erfc(z / std::sqrt(2.0));
}

/// Logarithm of the likelihood L of one value, and its derivatives, at z = (y - mu) / sigma.
struct Term {
  double logarithm = 0;  ///< ln L
  double first = 0;      ///< -d(ln L)/dz
  double second = 0;     ///< -d^2(ln L)/dz^2
};
using Distribution = Term (*)(double z, bool censored);

Term normal(double z, bool censored) {
  if (!censored) return {-z * z / 2, z, 1};
  const double hazard = normal_hazard(z);
  const double tail = -z * z / 2 - std::log(hazard * std::sqrt(2 * std::numbers::pi));
  return {z > -30 ? tail : 0, hazard, hazard * (hazard - z)};
}

/// Gumbel distribution of smallest values, shifted so that z is 0 at the mean.
Term gumbel(double z, bool censored) {
  const double power = std::exp(z -= std::numbers::egamma);
  return censored ? Term{-power, power, power} : Term{z - power, power - 1, power};
}

/// With mu = a + b x, z = (y - mu) / sigma is linear in three parameters: 1 / sigma, a / sigma and
/// b / sigma. Row k of `terms` has the coefficients for value k. A fixed parameter has a column of
/// zeros in `terms`.
struct Sample {
  CensoredValues values;
  Eigen::MatrixX3d terms;
  Distribution distribution;
};

/// ln L, its gradient (`slope`), and the negative of its Hessian matrix (`curvature`).
struct Expansion {
  double logarithm = 0;
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Identity() * 1e-12;  // keeps it invertible
};
Expansion expanded(const Sample& sample, const Eigen::Vector3d& at) {
  Expansion sum;
  if (!(at[0] > 0)) sum.logarithm = -infinite;
  for (Eigen::Index k = 0; k < sample.terms.rows(); ++k) {
    const Eigen::Vector3d x = sample.terms.row(k);
    const bool censored = sample.values[static_cast<std::size_t>(k)].censored;
    const Term term = sample.distribution(x.dot(at), censored);
    sum.logarithm += term.logarithm;
    sum.slope -= term.first * x;
    sum.curvature += term.second * x * x.transpose();
    if (censored) continue;
    sum.logarithm += std::log(at[0]);
    sum.slope[0] += 1 / at[0];
    sum.curvature(0, 0) += 1 / (at[0] * at[0]);
  }
  return sum;
}

/// Maximizes ln L by Newton's method, starting from `at`, and returns the maximum. A step that
/// would lower ln L is halved. If all observed values equal mu exactly, ln L has no maximum. The
/// iteration then ends when h = 1 / sigma reaches 1e8.
double maximize(const Sample& sample, Eigen::Vector3d& at) {
  Expansion here = expanded(sample, at);
  double gain = 1;
  for (int step = 0; step < 100 && gain > 1e-14 && at[0] < 1e8; ++step) {
    Eigen::Vector3d move = here.curvature.ldlt().solve(here.slope);
    gain = here.slope.dot(move);
    Expansion next = expanded(sample, at + move);
    while (!(next.logarithm >= here.logarithm) && move.norm() > 1e-14) {
      next = expanded(sample, at + (move /= 2));
    }
    if (!(next.logarithm >= here.logarithm)) break;
    at += move;
    here = next;
  }
  return here.logarithm;
}

struct Fit {
  double value = 0;
  Interval interval;
  double sigma = 0;
};

/// Fits the mean of the values or, if `x` is given, the slope b of the line a + b x. `t` is
/// Student's quantile for the interval; t = 0 gives no interval.
Fit fitted(CensoredValues values, std::span<const double> x, double t,
           Distribution distribution = normal) {
  const auto n = static_cast<double>(values.size());
  const double slope = x.empty() ? 0 : 1;
  // Model: the mean of y[k] is value * weight[k] + constant. The constant is 0 if `x` is empty.
  Eigen::VectorXd y(std::ssize(values)), weight(y.size());
  std::ranges::transform(values, y.begin(), &CensoredValue::value);
  std::ranges::copy(x, weight.begin());
  const auto centred = [n](Eigen::VectorXd& numbers) {  // shifts and scales to mean 0, variance 1
    numbers.array() -= numbers.mean();
    const double unit = numbers.norm() / std::sqrt(n);
    if (unit > 0) numbers /= unit;
    return unit > 0 ? unit : 1;
  };
  const double zero = x.empty() ? y.mean() : 0, unit = centred(y);
  const double scale = unit / (x.empty() ? 1 : centred(weight));
  if (x.empty()) weight.setOnes();
  Sample sample{values, Eigen::MatrixX3d(y.size(), 3), distribution};
  const auto highest = [&](double value, bool fixed, Eigen::Vector3d& at) {
    sample.terms << y - value * weight, (fixed ? 0 : -1) * weight,
        Eigen::VectorXd::Constant(y.size(), -slope);
    return maximize(sample, at);
  };
  Eigen::Vector3d best = Eigen::Vector3d::UnitX();
  const double most = highest(0, false, best), value = best[1] / best[0];
  const double limit = std::sqrt(n * std::log1p(t * t / (n - 1 - slope)));
  const auto end = [&](double side) {
    Eigen::Vector3d at = best;
    const auto excess = [&](double off) {
      return std::sqrt(std::max(0.0, 2 * (most - highest(value + side * off, true, at)))) - limit;
    };
    if (t == 0) return zero + scale * value;
    if (excess(1e3) < 0) return side * infinite;
    at = best;
    std::uintmax_t steps = 100;
    const auto found = boost::math::tools::bracket_and_solve_root(
        excess, limit / std::sqrt(n) / best[0], 2.0, true,
        boost::math::tools::eps_tolerance<double>(40), steps);
    return zero + scale * (value + side * (found.first + found.second) / 2);
  };
  return {zero + scale * value, {end(-1), end(1)}, unit / best[0]};
}

std::ptrdiff_t observed(CensoredValues values) {
  return std::ranges::count(values, false, &CensoredValue::censored);
}

std::vector<double> plain(CensoredValues values) {
  std::vector<double> numbers;
  for (const CensoredValue& one : values) numbers.push_back(one.value);
  return numbers;
}

/// Residuals (y - mean) / sigma, shifted so that they have zero mean. For a censored value: the
/// expected residual of the true value, given that the true value is above the censored value.
Eigen::VectorXd residuals(CensoredValues values, const Fit& fit) {
  Eigen::VectorXd found(std::ssize(values));
  std::ranges::transform(values, found.begin(), [&fit](const CensoredValue& one) {
    const double z = (one.value - fit.value) / fit.sigma;
    return one.censored ? normal_hazard(z) : z;
  });
  return found.array() - found.mean();
}

double quantile_at(double level, double freedom) {
  return student_quantile((1 + level) / 2, freedom);
}

}  // namespace

std::optional<Estimate> censored_mean(CensoredValues values, double level) {
  const std::size_t n = values.size();
  if (observed(values) == std::ssize(values)) return mean_of(plain(values), level);
  if (n < least_runs) return std::nullopt;
  if (observed(values) >= 2) {
    const double t = quantile_at(level, static_cast<double>(n - 1));
    const Fit found = fitted(values, {}, t);
    const Interval skewed = fitted(values, {}, t, gumbel).interval;
    const Interval both = {std::min(found.interval.low, skewed.low),
                           std::max(found.interval.high, skewed.high)};
    return estimate_with(found.value, both, t, n);
  }
  const bool bounded = std::exp2(-static_cast<double>(n)) <= (1 - level) / 2;
  const double low = bounded ? std::ranges::min(plain(values)) : -infinite;
  return Estimate{infinite, {low, infinite}, n, 1, infinite};
}

std::optional<Estimate> censored_difference(CensoredValues a, CensoredValues b, bool paired,
                                            double level) {
  if (observed(a) + observed(b) == std::ssize(a) + std::ssize(b)) {
    std::vector<double> x = plain(a), y = plain(b);
    if (!paired) return difference_of_means(x, y, level);
    std::ranges::transform(x, y, x.begin(), std::minus());
    return mean_of(x, level);
  }
  const std::size_t runs = std::min(a.size(), b.size());
  if (runs < least_runs || std::min(observed(a), observed(b)) < 2) return std::nullopt;
  const Fit first = fitted(a, {}, 0), second = fitted(b, {}, 0);
  const double n = static_cast<double>(a.size() - 1), m = static_cast<double>(b.size() - 1);
  const double xx = first.sigma * first.sigma / n, yy = second.sigma * second.sigma / m;
  const double welch = (xx + yy) * (xx + yy) / (xx * xx / n + yy * yy / m);
  const double t = quantile_at(level, paired ? n : welch);
  const Interval x = fitted(a, {}, t).interval, y = fitted(b, {}, t).interval;
  const Eigen::VectorXd u = residuals(a, first), v = residuals(b, second);
  const double norms = u.norm() * v.norm();
  const double rho = paired && norms > 0 ? u.dot(v) / norms : 0;
  const auto joined = [rho](double p, double q) {
    return std::isfinite(p + q) ? std::sqrt(std::max(0.0, p * p + q * q - 2 * rho * p * q))
                                : infinite;
  };
  const double value = first.value - second.value;
  Estimate found = estimate_with(value,
                                 {value - joined(first.value - x.low, y.high - second.value),
                                  value + joined(x.high - first.value, second.value - y.low)},
                                 t, runs);
  found.groups = paired ? 1 : 2;
  return found;
}

std::optional<Estimate> censored_slope(CensoredValues values, std::span<const double> x,
                                       double level) {
  if (observed(values) < 3 || std::ranges::min(x) == std::ranges::max(x)) return std::nullopt;
  const double t = quantile_at(level, static_cast<double>(values.size() - 2));
  const Fit found = fitted(values, x, t);
  Estimate slope = estimate_with(found.value, found.interval, t, values.size());
  double low = infinite, high = -infinite;  // smallest and largest x of observed values
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!values[k].censored) low = std::min(low, x[k]), high = std::max(high, x[k]);
  }
  const bool above = std::ranges::max(x) > high, below = std::ranges::min(x) < low;
  if (low == high && above != below) slope.value = above ? infinite : -infinite;
  return slope;
}

}  // namespace shearcell
