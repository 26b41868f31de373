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

/// What became of the crystallites of one size. A crystallite counts once at most. Omits
/// crystallites whose grains split equally between larger crystallites and elsewhere.
struct GrowthCount {
  std::size_t grew = 0;  ///< more than half of the grains are in larger crystallites
  /// Also more than half, but most grains of that larger crystallite come from another, larger one.
  std::size_t absorbed = 0;
  std::size_t shrank = 0;    ///< more than half of the grains are in smaller crystallites
  std::size_t vanished = 0;  ///< more than half are in smaller crystallites or in none

  std::size_t larger() const { return grew + absorbed; }     ///< what the supplement calls growing
  std::size_t smaller() const { return shrank + vanished; }  ///< what it calls shrinking
  GrowthCount& operator+=(const GrowthCount& other);
  bool operator==(const GrowthCount&) const = default;
};

/// Counts by size in grains, with an entry for every size that was followed.
using GrowthBySize = std::map<std::int32_t, GrowthCount>;

/// Follows every crystallite of `now` to `later` and counts it.
void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts);

/// Counts over all pairs of a run's checkpoints that are `cycles` apart. One crystallite is counted
/// at many cycles, so the counts of one run are not independent.
GrowthBySize growth_of(const FrameRun& run, std::int64_t cycles);

/// delta_rho = rho_g - rho_s in a bin of sizes, with rho_g = larger / (larger + smaller).
struct GrowthRate {
  double size = 0;  ///< geometric mean over the crystallites
  GrowthCount count;
  double delta = 0;
  /// The larger of two standard errors: of the bootstrap over runs, and of independent
  /// crystallites, 2 sqrt((larger + 1) (smaller + 1) / (n + 3)) / (n + 2), n = larger + smaller.
  double delta_error = 0;
};

/// Rates over all runs in bins of sizes. From the smallest size on, each bin takes sizes until it
/// has at least `least_counted` crystallites; a last bin with fewer is left out. By default each
/// size is a bin.
std::vector<GrowthRate> growth_rates(std::span<const GrowthBySize> runs,
                                     std::size_t least_counted = 1);

/// delta_rho as a smooth function of ln(size), by local linear regression: a line through delta_rho
/// of each size, weighted by its crystallites and a Gaussian of ln(size) around the size asked for
/// (J. Fan, J. Am. Stat. Assoc. 87, 998 (1992)). It assumes no shape of the curve. Runs are the
/// unit of every error.
class GrowthCurve {
 public:
  /// Standard deviation of the Gaussian in ln(size): sizes within about a fifth count. [choice]
  static constexpr double bandwidth = 0.2;
  /// Larger crystallites are left out: their growth ends when the cell is one crystal. [choice]
  static constexpr std::int32_t largest = 100;

  /// `background` is subtracted from delta_rho: crystallites grow where the rest is positive.
  explicit GrowthCurve(std::span<const GrowthBySize> runs, double background = 0);

  /// `size`: 1 to `largest` grains. Not a number if no crystallite was counted.
  double delta_rho(std::int32_t size) const;
  std::optional<double> delta_rho_error(std::int32_t size) const;  ///< of the bootstrap over runs

  /// The size at which delta_rho rises through zero. Of several such sizes, the one that best
  /// separates growing from shrinking: larger crystallites have the greatest excess of growing
  /// ones. Empty for fewer than least_bootstrap_runs, or without such a size. The interval is the
  /// bootstrap's. An end is infinite if all sizes grow, or none does, in too many of its
  /// selections.
  std::optional<Estimate> critical_size() const;
  /// The size that maximizes the excess of growing over shrinking crystallites of this size and
  /// above. There the monotone (isotonic) fit of the unsmoothed delta_rho crosses zero (M. Ayer et
  /// al., Ann. Math. Stat. 26, 641 (1955)). A check of critical_size() with a larger error.
  std::optional<Estimate> monotone_critical_size() const;
  /// 90 % interval of the critical size in repeated studies with `runs` runs.
  Interval repeated_critical_size(std::size_t runs) const;

 private:
  /// For each size, numbers that are linear in the counts and so add over runs: moments of the
  /// crystallites near the size, and the excess of growing crystallites from the size on.
  using Sums = Eigen::Array<double, largest, 6>;
  std::vector<Sums> runs_;

  Sums over(std::span<const std::size_t> selection) const;
};

}  // namespace shearcell
