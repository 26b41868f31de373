// SPDX-License-Identifier: GPL-3.0-or-later
// Means, differences and slopes of censored values. Only a lower limit of a censored value is
// known: phi at the onset is above the last phi if the run ended before its onset. J. Tobin,
// Econometrica 26, 24 (1958); A. C. Cohen, Technometrics 1, 217 (1959).
//
// Model: y ~ N(mu, sigma), where mu is the mean or the line a + b x. The likelihood L of observed
// values y and lower limits c is given by
//
//     ln L = sum over observed -ln sigma - (y - mu)^2 / (2 sigma^2)
//          + sum over censored ln Q((c - mu) / sigma)
//
// ln L is concave in h = 1 / sigma and g = mu / sigma: R. J. Olsen, Econometrica 46, 1211 (1978).
// The confidence interval of a mean or slope holds the values at which ln L, maximized over the
// other parameters, is at most n ln(1 + t^2 / f) / 2 below its maximum. Here t is Student's
// quantile for f degrees of freedom, with f = n - 1 for a mean and n - 2 for a slope. Without
// censoring this is Student's interval. README.md states how often the intervals hold the true
// value. Values must be finite. Nothing is estimated from fewer than least_runs values.
#pragma once

#include <optional>
#include <span>

#include "analysis/statistics.hpp"

namespace shearcell {

/// Value of one run. If `censored`, the true value is larger than `value`.
struct CensoredValue {
  double value = 0;
  bool censored = false;
};

/// Mean of the values. The distribution of phi at the onset is skewed, since its hazard rises with
/// phi. If a value is censored, the interval is therefore the union of two intervals, from a normal
/// distribution and from a Gumbel distribution of smallest values, whose hazard is exponential.
/// With fewer than two observed values the estimate is infinite, and the interval begins at the
/// smallest value if the sign test allows this bound: 2^-n <= (1 - level) / 2.
std::optional<Estimate> censored_mean(std::span<const CensoredValue> values,
                                      double level = confidence_level);

/// Difference mean(a) - mean(b), from the normal intervals of both means. The groups may differ in
/// sigma: G. Y. Zou and A. Donner, Stat. Med. 27, 1693 (2008). Independent groups have Welch's
/// degrees of freedom. If `paired`, a[k] and b[k] share a packing, and the errors of the means are
/// correlated like the residuals (G. Y. Zou, Psychol. Methods 12, 399 (2007)). The residual of a
/// censored value is its expectation. Pairs with censored values count. Treating a[k] - b[k] as one
/// censored value would be biased, since b[k] decides whether the difference is censored. Without
/// censoring these are the intervals of Welch and of Student (pairs). Empty if a group has fewer
/// than two observed values.
std::optional<Estimate> censored_difference(std::span<const CensoredValue> a,
                                            std::span<const CensoredValue> b, bool paired,
                                            double level = confidence_level);

/// Slope b of values[k] ~ a + b x[k], with one sigma for all x. Empty for fewer than three observed
/// values, or if all x are equal. If all observed values have the same x, and all other x lie on
/// one side of this x, a steeper slope is always more likely. The estimate and one end of the
/// interval are then infinite.
std::optional<Estimate> censored_slope(std::span<const CensoredValue> values,
                                       std::span<const double> x, double level = confidence_level);

}  // namespace shearcell
