// SPDX-License-Identifier: GPL-3.0-or-later
// Do crystallites of a size grow or shrink, and from which size on do they grow? Supplement C.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// What became of the crystallites of one size. Each is counted once at most: those of which as
/// many grains are in larger crystallites as elsewhere are left out.
struct GrowthCount {
  std::size_t grew = 0;  ///< more than half of the grains are in larger crystallites
  /// Likewise, but most grains of the crystallite that they end in come from a larger one.
  std::size_t absorbed = 0;
  std::size_t shrank = 0;    ///< more than half are in smaller ones
  std::size_t vanished = 0;  ///< more than half are in smaller ones or in none

  std::size_t larger() const { return grew + absorbed; }  ///< that grew, in the supplement's sense
  std::size_t smaller() const { return shrank + vanished; }  ///< that shrank
  GrowthCount& operator+=(const GrowthCount& other);
  bool operator==(const GrowthCount&) const = default;
};

/// By size in grains; has every size that was followed.
using GrowthBySize = std::map<std::int32_t, GrowthCount>;

/// Follows every crystallite of `now` to `later` and counts it.
void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts);

/// Of all pairs of checkpoints of a run that are `cycles` apart, from every cycle on. One
/// crystallite is counted at many cycles, so counts of one run are not independent.
GrowthBySize growth_of(const FrameRun& run, std::int64_t cycles);

/// delta_rho = rho_g - rho_s in a bin of sizes, with rho_g = larger / (larger + smaller).
struct GrowthRate {
  double size = 0;  ///< geometric mean over crystallites; of one size, that up to rounding
  GrowthCount count;
  double delta = 0;
  /// Standard error of the bootstrap over runs, or that of independent crystallites if that is
  /// greater: 2 sqrt((larger + 1) (smaller + 1) / (n + 3)) / (n + 2), n = larger + smaller.
  double delta_error = 0;
};

/// Of all runs, in bins of sizes: each bin takes sizes, from the smallest on, until it has at least
/// `least_counted` crystallites. By default a bin is one size. The last bin is left out if it has
/// fewer.
std::vector<GrowthRate> growth_rates(std::span<const GrowthBySize> runs,
                                     std::size_t least_counted = 1);

/// delta_rho as a smooth function of ln(size), by local linear regression: a line through delta_rho
/// of each size, weighted by its crystallites and a Gaussian of ln(size) around the size asked for
/// (J. Fan, J. Am. Stat. Assoc. 87, 998 (1992)). It assumes no shape of the curve. Runs are the
/// unit of every error.
class GrowthCurve {
 public:
  /// Standard deviation of that Gaussian [choice]: sizes of up to a fifth more or less count.
  static constexpr double bandwidth = 0.2;
  /// Larger crystallites are left out: their growth ends when the cell is one crystal. [choice]
  static constexpr std::int32_t largest = 100;

  /// delta_rho is counted from `background`, above which crystallites are said to grow.
  explicit GrowthCurve(std::span<const GrowthBySize> runs, double background = 0);

  /// Of 1 to `largest` grains. Not a number if no crystallite was counted.
  double delta_rho(std::int32_t size) const;
  std::optional<double> delta_rho_error(std::int32_t size) const;  ///< of the bootstrap over runs

  /// The size at which delta_rho rises through zero. If there are several, that which best tells
  /// those that grew from those that shrank: with the greatest excess of the former among larger
  /// ones. None for fewer than least_bootstrap_runs, or if there is no such size. The interval is
  /// the bootstrap's; an end is infinite if all sizes grow, or none does, in too many selections of
  /// runs.
  std::optional<Estimate> critical_size() const;
  /// The size from which on the excess of those that grew is greatest. An unsmoothed delta_rho that
  /// may only rise with size crosses zero there (M. Ayer et al., Ann. Math. Stat. 26, 641 (1955)).
  /// Tests critical_size(), with a larger error.
  std::optional<Estimate> monotone_critical_size() const;
  /// Where the critical size of 90 % of repetitions with so many runs would lie.
  Interval repeated_critical_size(std::size_t runs) const;

 private:
  /// Of each size, what is linear in the counts, so that it may be added over runs: moments of the
  /// crystallites near it, and the excess of those that grew from this size on.
  using Sums = Eigen::Array<double, largest, 6>;
  std::vector<Sums> runs_;

  Sums over(std::span<const std::size_t> selection) const;
};

}  // namespace shearcell
