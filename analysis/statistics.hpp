// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates over independent runs: means, errors, confidence intervals, the bootstrap, the number
// of runs that a decision needs, and waiting times.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace shearcell {

struct RunStatistics {
  std::size_t runs = 0;
  std::optional<double> mean;            ///< none without runs
  std::optional<double> standard_error;  ///< sqrt(sum (x - mean)^2 / (n (n - 1))); none for n < 2
};

/// One value per run. Values that are not finite are left out and not counted.
RunStatistics over_runs(std::span<const double> values);

/// The root mean square, as `mean`, with the error of the mean square over twice the root.
RunStatistics rms_over_runs(std::span<const double> values);

/// Slope of the straight line of y against x, by least squares; not a number if all x are equal.
double least_squares_slope(std::span<const std::pair<double, double>> points);

/// A number computed from a selection of runs, in which a run may occur several times; not a number
/// if a selection has none. The bootstrap takes 1000 selections, drawn with replacement by a
/// counter-based generator, so the same input gives the same values.
using RunStatistic = std::function<double(std::span<const std::size_t>)>;

/// Standard error of a statistic: standard deviation over the selections times
/// sqrt(runs / (runs - 1)), so that the error of a mean is that of over_runs(). None for fewer than
/// two runs, or if fewer than half of the selections have a finite value.
std::optional<double> bootstrap_error(std::size_t runs, const RunStatistic& statistic);

/// Confidence level of intervals unless a level is given. A 90 % interval that lies within a margin
/// is equivalent to two one-sided tests at 5 %: Schuirmann, J. Pharmacokinet. Biopharm. 15, 657
/// (1987).
inline constexpr double confidence_level = 0.9;

/// With fewer runs, or fewer pairs of runs, nothing is estimated. [choice]
inline constexpr std::size_t least_runs = 3;
/// Fewest runs for the bootstrap. Its interval of a mean lies between the smallest and the largest
/// run, and these enclose the median with a probability of 1 - 2^(1 - runs): 75 % for 3 runs, 94 %
/// for 5.
inline constexpr std::size_t least_bootstrap_runs = 5;

/// An end of an interval without a bound.
inline constexpr double infinite = std::numeric_limits<double>::infinity();

struct Interval {
  double low = 0;
  double high = 0;
};

struct Estimate {
  double value = 0;
  Interval interval;       ///< an end may be infinite
  std::size_t runs = 0;    ///< or pairs; of two groups the smaller one
  std::size_t groups = 1;  ///< 2: two independent groups
  double spread = 0;       ///< the standard error would be spread / sqrt(n) with n runs a group
};

/// The estimate with an interval whose ends are `quantile` standard errors from its middle.
Estimate estimate_with(double value, const Interval& interval, double quantile, std::size_t runs);

/// Applies an increasing function to the value and the interval; the spread does not change.
Estimate mapped(Estimate estimate, const std::function<double(double)>& increasing);

/// Quantiles of Student's t with `freedom` degrees of freedom and of the normal distribution.
double student_quantile(double probability, double freedom);
double normal_quantile(double probability);

/// Mean of one value per run, or per pair of runs, by Student's t: mean +- t s / sqrt(n).
std::optional<Estimate> mean_of(std::span<const double> values, double level = confidence_level);

/// mean(a) - mean(b) of two independent groups that may differ in variance: B. L. Welch,
/// Biometrika 34, 28 (1947).
std::optional<Estimate> difference_of_means(std::span<const double> a, std::span<const double> b,
                                            double level = confidence_level);

/// Estimates any statistic by the bootstrap, with the expanded percentile interval: T. C.
/// Hesterberg, The American Statistician 69, 371 (2015). For a mean this interval has the length of
/// Student's. The statistic of a selection may be infinite; selections without a statistic widen
/// the interval at both ends. Empty for fewer than least_bootstrap_runs, or if the statistic of all
/// runs is not finite.
std::optional<Estimate> bootstrapped(std::size_t runs, const RunStatistic& statistic,
                                     double level = confidence_level);

/// 90 % interval of the statistic in repeated studies with `chosen` runs: its 5 and 95 % quantiles
/// if `chosen` of the `runs` are drawn with replacement. Unbounded for fewer than
/// least_bootstrap_runs.
Interval repetitions(std::size_t runs, std::size_t chosen, const RunStatistic& statistic);

/// Standard deviation between the true means of groups that are drawn from many (one-way random
/// effects).
struct SpreadBetween {
  double value = 0;        ///< sqrt of (variance between groups - variance within) / group size
  double upper_limit = 0;  ///< exceeds the true one with the probability (1 + level) / 2
  double f = 0;            ///< variance ratio; with no difference between groups it is about 1
};
/// Analysis of variance of groups of one value per run, which may be of unequal size: S. R. Searle,
/// G. Casella and C. E. McCulloch, Variance Components (1992), section 3.6. The upper limit is that
/// of J. S. Williams, Biometrika 49, 278 (1962), with k groups and f = n - k:
///
///     limit^2 = (k - 1) MSB (1 - F / f_ratio) / (n0 chi^2),   F, chi^2: (1 - level) / 2
/// quantiles
///
/// None for fewer than two groups with values, or without a group of two.
std::optional<SpreadBetween> variance_between(std::span<const std::vector<double>> groups,
                                              double level = confidence_level);

/// a / b of two independent estimates of positive quantities. At each end of the interval, the
/// errors of both logarithms that move the ratio to this end are added in squares: G. Y. Zou and A.
/// Donner, Stat. Med. 27, 1693 (2008).
Estimate ratio(const Estimate& a, const Estimate& b);

/// Runs per group, or pairs, from which on an interval excludes a value at `distance` from the
/// truth with 90 % probability; on both sides of the truth if `both_sides`. Normal theory, with
/// Student's t for both errors: Chow, Shao and Wang, Sample Size Calculations in Clinical Research
/// (2008), section 3.2. None if the number is more than 10000. The spread of a
/// few runs is uncertain, and so is the number: the true number is 0.3 to 20 times the number found
/// from 3 runs, and 0.5 to 4 times the number found from 6 runs.
std::optional<std::size_t> runs_to_resolve(const Estimate& estimate, double distance,
                                           bool both_sides);

// Waiting times of which some end unobserved: the cycle of the onset in runs that may stop before.

/// One run: the cycle of the event, or, censored, the last cycle without one.
struct Waiting {
  double cycle = 0;
  bool observed = false;
};

/// Probability to wait longer than `cycle`; it holds until the next step.
struct SurvivalStep {
  double cycle = 0;
  double survival = 1;
};

/// The product-limit estimate, a step at each observed cycle: E. L. Kaplan and P. Meier, J. Am.
/// Stat. Assoc. 53, 457 (1958).
std::vector<SurvivalStep> kaplan_meier(std::span<const Waiting> runs);

/// The first cycle after which less than half of the runs still wait. If exactly half of the runs
/// wait between two cycles, the middle of these cycles. None if more than half wait at the end.
std::optional<double> median_wait(std::span<const Waiting> runs);

/// The log-rank statistic: events of `a` observed and expected if both groups wait alike, over the
/// standard deviation of their difference. Positive if `a` is the earlier group, 0 without events.
/// N. Mantel, Cancer Chemother. Rep. 50, 163 (1966).
double log_rank(std::span<const Waiting> a, std::span<const Waiting> b);

/// log2 of the factor by which the waits of `a` are longer than those of `b`. With this factor the
/// log-rank statistic of `a` against the scaled waits of `b` vanishes. The interval holds the
/// factors that the log-rank test does not reject (A. A. Tsiatis, Ann. Stat. 18, 354 (1990)). The
/// test compares with Student's t, n + m - 2 degrees of freedom: with the normal distribution the
/// intervals of 4 to 12 runs a group cover 86 to 88 %. The interval is infinite where too few
/// events were observed. None for fewer than least_runs in a group, or without an event.
std::optional<Estimate> log2_wait_ratio(std::span<const Waiting> a, std::span<const Waiting> b,
                                        double level = confidence_level);

}  // namespace shearcell
