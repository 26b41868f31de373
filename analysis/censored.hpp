// SPDX-License-Identifier: GPL-3.0-or-later
// Means, differences and slopes of values of which some are only known to be larger than stated:
// phi at the onset, of runs that may end before their onset. J. Tobin, Econometrica 26, 24 (1958);
// A. C. Cohen, Technometrics 1, 217 (1959).
//
// y ~ N(mu, sigma), with mu the mean or the line a + b x. The likelihood L of values y and c:
//
//     ln L = sum over observed -ln sigma - (y - mu)^2 / (2 sigma^2)
//          + sum over censored ln Q((c - mu) / sigma)
//
// which is concave in h = 1 / sigma and g = mu / sigma: R. J. Olsen, Econometrica 46, 1211 (1978).
// An interval holds the values at which ln L, maximal in all else, is at most
// n ln(1 + t^2 / f) / 2 below its maximum: f = n - 1 for a mean, n - 2 for a slope; t is Student's
// quantile for f. Without censoring this is Student's interval. How often intervals hold the true
// value: README.md. Values must be finite. Nothing is estimated from fewer than least_runs values.
#pragma once

#include <optional>
#include <span>

#include "analysis/statistics.hpp"

namespace shearcell {

/// The value of one run; if `censored`, the true value is larger.
struct CensoredValue {
  double value = 0;
  bool censored = false;
};

/// phi at the onset is skewed: its hazard rises with phi. If a value is censored, the interval is
/// therefore the union of the normal one and that of a Gumbel distribution of smallest values,
/// whose hazard is exponential. With fewer than two observed values the estimate is infinite, and
/// the smallest value bounds the interval by the sign test, if 2^-n <= (1 - level) / 2.
std::optional<Estimate> censored_mean(std::span<const CensoredValue> values,
                                      double level = confidence_level);

/// mean(a) - mean(b) from the normal intervals of both means, which may differ in sigma: G. Y. Zou
/// and A. Donner, Stat. Med. 27, 1693 (2008). Independent groups have Welch's degrees of freedom.
/// If `paired`, a[k] and b[k] share a packing, and the errors have the correlation of the residuals
/// (G. Y. Zou, Psychol. Methods 12, 399 (2007)), of a censored value its expectation. Pairs with
/// one or two censored values count; a[k] - b[k] as a censored value would be biased, as b[k]
/// decides whether it is censored. Without censoring the intervals are those of Welch and Student.
/// None for fewer than two observed values in a group.
std::optional<Estimate> censored_difference(std::span<const CensoredValue> a,
                                            std::span<const CensoredValue> b, bool paired,
                                            double level = confidence_level);

/// Slope b of values[k] ~ a + b x[k], with the same sigma at every x. None for fewer than three
/// observed values, or if all x are equal. If all observed values are at one x, and all censored
/// values of other x are on one side of it, any steeper slope is more likely: the estimate and one
/// end of the interval are then infinite.
std::optional<Estimate> censored_slope(std::span<const CensoredValue> values,
                                       std::span<const double> x, double level = confidence_level);

}  // namespace shearcell
