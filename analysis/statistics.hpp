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
  std::optional<double> mean;            ///< empty without runs
  std::optional<double> standard_error;  ///< sqrt(sum (x - mean)^2 / (n (n - 1))); empty for n < 2
};

/// Statistics of one value per run. Values that are not finite are not counted.
RunStatistics over_runs(std::span<const double> values);

/// `mean` is the root mean square (rms). Its error is error(mean square) / (2 rms).
RunStatistics rms_over_runs(std::span<const double> values);

/// Slope of the least-squares line of y against x; NaN if all x are equal.
double least_squares_slope(std::span<const std::pair<double, double>> points);

/// Computes a statistic of a sample from the indices of its runs; NaN if it is undefined. A run may
/// occur several times, since the bootstrap draws 1000 samples with replacement. The random numbers
/// of the bootstrap are counter-based, so the same input gives the same samples.
using RunStatistic = std::function<double(std::span<const std::size_t>)>;
/// The mean of all items of the selected groups. A group has the items of one packing.
RunStatistic mean_of_items(std::span<const std::vector<double>> groups);

/// Standard error of a statistic: its standard deviation over the bootstrap samples, multiplied by
/// sqrt(runs / (runs - 1)). For a mean it agrees with over_runs(). Empty for fewer than two runs,
/// or if fewer than half of the samples have a finite value.
std::optional<double> bootstrap_error(std::size_t runs, const RunStatistic& statistic);

/// Confidence level of intervals unless a level is given. Requiring that a 90 % interval lies
/// between -margin and margin is equivalent to two one-sided tests at 5 %: Schuirmann,
/// J. Pharmacokinet. Biopharm. 15, 657 (1987).
inline constexpr double confidence_level = 0.9;

/// Minimum number of runs, or of pairs of runs, for an estimate. [choice]
inline constexpr std::size_t least_runs = 3;
/// Minimum number of runs for the bootstrap. A bootstrap interval of a mean lies between the
/// smallest and the largest value. These two values enclose the median of the distribution with a
/// probability of 1 - 2^(1 - runs): 75 % for 3 runs, 94 % for 5.
inline constexpr std::size_t least_bootstrap_runs = 5;

inline constexpr double infinite = std::numeric_limits<double>::infinity();

struct Interval {
  double low = 0;
  double high = 0;
};

struct Estimate {
  double value = 0;
  Interval interval;       ///< an end may be infinite
  std::size_t runs = 0;    ///< number of runs or pairs; with 2 groups, runs in the smaller group
  std::size_t groups = 1;  ///< 1, or 2 independent groups
  double spread = 0;       ///< with n runs per group the standard error would be spread / sqrt(n)
};

/// Makes an estimate from an interval with a half-width of `quantile` standard errors.
Estimate estimate_with(double value, const Interval& interval, double quantile, std::size_t runs);

/// Applies an increasing function to the value and the interval, but not to the spread.
Estimate mapped(Estimate estimate, const std::function<double(double)>& increasing);

/// Quantiles of Student's t (with `freedom` degrees of freedom) and of the normal distribution.
double student_quantile(double probability, double freedom);
double normal_quantile(double probability);

/// Mean of `values`, with Student's interval: mean +- t s / sqrt(n). Each run or pair of runs gives
/// one value.
std::optional<Estimate> mean_of(std::span<const double> values, double level = confidence_level);

/// Difference mean(a) - mean(b) of two independent groups, whose variances may differ: B. L. Welch,
/// Biometrika 34, 28 (1947).
std::optional<Estimate> difference_of_means(std::span<const double> a, std::span<const double> b,
                                            double level = confidence_level);

/// Estimates any statistic by the bootstrap, with the expanded percentile interval: T. C.
/// Hesterberg, The American Statistician 69, 371 (2015). For a mean, this interval is as long as
/// Student's interval. The statistic may be infinite. A bootstrap sample whose
/// statistic is NaN widens the interval at both ends. Empty for fewer than least_bootstrap_runs, or
/// if the statistic of all runs together is not finite.
std::optional<Estimate> bootstrapped(std::size_t runs, const RunStatistic& statistic,
                                     double level = confidence_level);

/// Interval that contains the statistic in 90 % of repeated studies. Its ends are the 5 % and 95 %
/// quantiles over random samples of size `chosen`, drawn with replacement from all runs. `runs`:
/// number of all runs. Unbounded if `runs` is less than least_bootstrap_runs.
Interval repetitions(std::size_t runs, std::size_t chosen, const RunStatistic& statistic);

/// Standard deviation of the true means of groups in a one-way random-effects model.
struct SpreadBetween {
  double value = 0;        ///< sqrt((variance between groups - variance within) / group size)
  double upper_limit = 0;  ///< exceeds the true value with the probability (1 + level) / 2
  double f = 0;            ///< variance ratio; about 1 if the groups do not differ
};
/// Analysis of variance of groups with one value per run. The groups may differ in size: S. R.
/// Searle, G. Casella and C. E. McCulloch, Variance Components (1992), section 3.6. `upper_limit`
/// is from J. S. Williams, Biometrika 49, 278 (1962). For k groups with n values in total, the
/// limit is given by
///
///     limit^2 = (k - 1) (MSB - F MSW) / (n0 chi^2)
///
/// MSB and MSW are the mean squares between and within groups. n0 is the effective group size.
/// F(k - 1, n - k) and chi^2(k - 1) are quantiles at (1 - level) / 2. The result is empty for
/// fewer than two groups with values, or if no group has two values.
std::optional<SpreadBetween> variance_between(std::span<const std::vector<double>> groups,
                                              double level = confidence_level);

/// a / b - 1 of two independent estimates of positive quantities; empty if one of them is empty.
/// The lower error of ln(a / b) is the lower error of ln a and the upper error of ln b, added in
/// quadrature. The upper error is the upper error of ln a and the lower error of ln b, added in
/// quadrature. Source: G. Y. Zou and A. Donner, Stat. Med. 27, 1693 (2008).
std::optional<Estimate> relative_difference(const std::optional<Estimate>& a,
                                            const std::optional<Estimate>& b);

/// Number of runs per group (or of pairs) that are needed so that, with 90 % probability, the
/// interval excludes a value at `distance` from the true value. With `both_sides` the interval must
/// exclude both values at this distance. A normal distribution is assumed, with Student's t for
/// type I and type II errors: Chow, Shao and Wang, Sample Size Calculations in Clinical Research
/// (2008), section 3.2. Empty if the number is more than 10000. The spread of a few runs is
/// uncertain. If the estimate comes from 3 runs, the number really needed is 0.3 to 20 times the
/// result; if it comes from 6 runs, 0.5 to 4 times the result.
std::optional<std::size_t> runs_to_resolve(const Estimate& estimate, double distance,
                                           bool both_sides);

/// Value of one run. If `censored`, the true value is larger than `value`.
struct CensoredValue {
  double value = 0;
  bool censored = false;
};

// CensoredValue times, such as the cycle of the onset. A run that stops before its event is
// censored at its last cycle.

/// Probability of waiting longer than `cycle`, constant until the next step.
struct SurvivalStep {
  double cycle = 0;
  double survival = 1;
};

/// The product-limit estimate, with a step at each cycle that has an event: E. L. Kaplan and P.
/// Meier, J. Am. Stat. Assoc. 53, 457 (1958).
std::vector<SurvivalStep> kaplan_meier(std::span<const CensoredValue> runs);

/// Returns the first cycle after which fewer than half of the runs still wait. If exactly half wait
/// between two events, returns the mean of their cycles. Empty if more than half wait at the end.
std::optional<double> median_wait(std::span<const CensoredValue> runs);

/// The log-rank statistic: the number of events of `a`, minus the number expected if both groups
/// wait equally long, divided by the standard deviation of this difference. Positive if the events
/// of `a` come earlier; 0 if there are no events. N. Mantel, Cancer Chemother. Rep. 50, 163 (1966).
double log_rank(std::span<const CensoredValue> a, std::span<const CensoredValue> b);

/// log2 of the ratio of the waiting times in `a` to those in `b`. If those in `b` are multiplied
/// by this ratio, the log-rank statistic is zero. The interval contains all ratios that the
/// log-rank test does not reject (A. A. Tsiatis, Ann. Stat. 18, 354 (1990)). The test uses
/// Student's t with n + m - 2 degrees of freedom, where n and m are the numbers of runs in `a` and
/// `b`. With the normal distribution and 4 to 12 runs in each group, only 86 to 88 % of the 90 %
/// intervals would contain the true ratio. The interval is infinite if too few events were
/// observed. Empty if there is no event, or a group has fewer than least_runs.
std::optional<Estimate> log2_wait_ratio(std::span<const CensoredValue> a,
                                        std::span<const CensoredValue> b,
                                        double level = confidence_level);

}  // namespace shearcell
