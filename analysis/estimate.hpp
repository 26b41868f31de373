// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates over independent runs, their confidence intervals, and the number of runs that a
// decision needs.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "analysis/statistics.hpp"

namespace shearcell {

/// Of every interval. An interval at 90 % within a margin is the two one-sided tests at 5 % of
/// Schuirmann, J. Pharmacokinet. Biopharm. 15, 657 (1987).
inline constexpr double confidence_level = 0.9;

/// With fewer runs, or fewer pairs of runs, nothing is estimated. [choice]
inline constexpr std::size_t least_runs = 3;

struct Interval {
  double low = 0;
  double high = 0;
};

struct Estimate {
  double value = 0;
  Interval interval;       ///< at confidence_level; an end may be infinite
  std::size_t runs = 0;    ///< or pairs; of two groups the smaller one
  std::size_t groups = 1;  ///< 2: two independent groups
  double spread = 0;       ///< the standard error would be spread / sqrt(n) with n runs a group
};

/// Quantiles of Student's t with `freedom` degrees of freedom and of the normal distribution.
double student_quantile(double probability, double freedom);
double normal_quantile(double probability);

/// Mean of one value per run, or per pair of runs, by Student's t: mean +- t s / sqrt(n).
std::optional<Estimate> mean_of(std::span<const double> values);

/// mean(a) - mean(b) of two independent groups that may differ in variance: B. L. Welch,
/// Biometrika 34, 28 (1947).
std::optional<Estimate> difference_of_means(std::span<const double> a, std::span<const double> b);

/// A statistic of a selection of runs that is not a mean. Expanded percentile interval of the
/// bootstrap, which has the length of Student's interval where the statistic is a mean: T. C.
/// Hesterberg, The American Statistician 69, 371 (2015). Selections that have no statistic widen
/// the interval at both ends. None when all runs together have no statistic.
std::optional<Estimate> bootstrapped(std::size_t runs, const RunStatistic& statistic);

/// Runs per group, or pairs, from which on an interval excludes a value at `distance` from the
/// truth with 90 % probability; on both sides of the truth if `both_sides`. Normal theory, with
/// Student's t for both errors: Chow, Shao and Wang, Sample Size Calculations in Clinical Research
/// (2008), section 3.2. None when it is more than 10000.
std::optional<std::size_t> runs_to_resolve(const Estimate& estimate, double distance,
                                           bool both_sides);

}  // namespace shearcell
