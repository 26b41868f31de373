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
// The confidence interval of a mean or slope of n values holds the means or slopes at which ln L,
// maximized over the other parameters, is at most n ln(1 + t^2 / f) / 2 below its maximum. Here t
// is Student's quantile for f degrees of freedom, with f = n - 1 for a mean and n - 2 for a slope.
// Without censoring this is Student's interval. README.md states how often the intervals hold the
// true value. Values must be finite. Nothing is estimated from fewer than least_runs values.
#pragma once

#include <optional>
#include <span>

#include "analysis/statistics.hpp"

namespace shearcell {

/// Mean of the values. If a value is censored, the interval is the union of two intervals: one
/// for a normal distribution and one for a Gumbel distribution of smallest values. The Gumbel
/// distribution is included because phi at the onset is skewed: the hazard of an onset rises with
/// phi, and the hazard of the Gumbel distribution rises exponentially. With fewer than two observed
/// values the estimate is infinite. In this case the interval begins at the smallest value if
/// 2^-n <= (1 - level) / 2 (sign test), otherwise at -infinity. Here n is the number of all values,
/// observed and censored.
std::optional<Estimate> censored_mean(std::span<const CensoredValue> values,
                                      double level = confidence_level);

/// Difference mean(a) - mean(b), from the normal intervals of the two means. The groups may differ
/// in sigma: G. Y. Zou and A. Donner, Stat. Med. 27, 1693 (2008). For independent groups Welch's
/// degrees of freedom are used. If `paired`, a[k] and b[k] share a packing. The correlation of the
/// two means is then the correlation of the residuals (G. Y. Zou, Psychol. Methods 12, 399 (2007)).
/// A residual is a value minus the mean of its group. Pairs with a censored value are included: the
/// unknown residual of this value is replaced by its conditional expectation. The condition is that
/// the true value is larger than the censored value. Treating a[k] - b[k] as one censored value
/// would give a bias, because the censoring of this difference depends on b[k]. If no value is
/// censored, the interval is Welch's interval or, for pairs, Student's interval. Empty if a group
/// has fewer than two observed values.
std::optional<Estimate> censored_difference(std::span<const CensoredValue> a,
                                            std::span<const CensoredValue> b, bool paired,
                                            double level = confidence_level);

/// Slope b of values[k] ~ a + b x[k]. sigma is the same for all x. Empty for fewer than three
/// observed values, or if all x are equal. Suppose that all observed values have the same x, and
/// that some censored values have a larger x but none has a smaller x (or vice versa). The
/// likelihood then has no maximum: it increases with the steepness of the slope. The estimate and
/// one end of the interval are then infinite.
std::optional<Estimate> censored_slope(std::span<const CensoredValue> values,
                                       std::span<const double> x, double level = confidence_level);

}  // namespace shearcell
