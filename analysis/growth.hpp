// SPDX-License-Identifier: GPL-3.0-or-later
// Growth and shrinkage of crystallites by size, and the critical size. Supplement C.
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

/// Numbers of crystallites that have s grains at one checkpoint and grow or shrink until a later
/// checkpoint. Each crystallite is counted at most once. A crystallite is not counted, for example,
/// if more than half of its grains are later in crystallites of s grains.
struct GrowthCount {
  /// Crystallites that have more than half of their grains in larger crystallites later, without
  /// those in `absorbed`.
  std::size_t grew = 0;
  /// Crystallites that have more than half of their grains in larger crystallites later, and were
  /// absorbed: the later crystallite that has the most of their grains has more grains from an
  /// earlier crystallite with more than s grains than from any other.
  std::size_t absorbed = 0;
  /// Crystallites that have more than half of their grains in smaller crystallites later.
  std::size_t shrank = 0;
  /// Crystallites that have more than half of their grains in smaller crystallites or in none
  /// later, without those in `shrank`.
  std::size_t vanished = 0;

  std::size_t larger() const { return grew + absorbed; }     ///< "growing" in the supplement
  std::size_t smaller() const { return shrank + vanished; }  ///< "shrinking" in the supplement
  GrowthCount& operator+=(const GrowthCount& other);
  bool operator==(const GrowthCount&) const = default;
};

/// Counts for each crystallite size [grains]. A size has an entry if a crystallite of this size
/// was followed.
using GrowthBySize = std::map<std::int32_t, GrowthCount>;

/// Adds the crystallites of `now` to `counts`. `later` is the map of the later checkpoint.
void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts);

/// Counts over all pairs of a run's checkpoints that are `cycles` apart. One crystallite is counted
/// at many cycles, so the counts of one run are not independent.
GrowthBySize growth_of(const FrameRun& run, std::int64_t cycles);

/// For a bin of sizes: delta_rho = rho_g - rho_s = (larger - smaller) / (larger + smaller).
struct GrowthRate {
  double size = 0;  ///< geometric mean size of the crystallites in the bin [grains]
  GrowthCount count;
  double delta = 0;
  /// The maximum of two standard errors: the bootstrap error over runs, and the error for
  /// independent crystallites, 2 sqrt((a + 1) (b + 1) / (n + 3)) / (n + 2). Here a is
  /// count.larger(), b is count.smaller(), and n = a + b.
  double delta_error = 0;
};

/// Rates over all runs in bins of sizes. A bin is filled with sizes in ascending order until it has
/// at least `least_counted` crystallites. A last bin with fewer crystallites is left out. By
/// default each bin has one size.
std::vector<GrowthRate> growth_rates(std::span<const GrowthBySize> runs,
                                     std::size_t least_counted = 1);

/// delta_rho as a smooth function of ln(size), by local linear regression: a line is fitted to
/// delta_rho around each size (J. Fan, J. Am. Stat. Assoc. 87, 998 (1992)). Weights are the number
/// of crystallites times a Gaussian of the distance in ln(size). The fit assumes no
/// particular shape of the curve. All errors come from the bootstrap over runs.
class GrowthCurve {
 public:
  /// Standard deviation of the Gaussian, in ln(size); corresponds to about 20 % in size. [choice]
  static constexpr double bandwidth = 0.2;
  /// Larger crystallites are left out, because their growth ends when the whole cell is one
  /// crystal. [choice]
  static constexpr std::int32_t largest = 100;

  /// `background` is subtracted from delta_rho; crystallites grow where the difference is positive.
  explicit GrowthCurve(std::span<const GrowthBySize> runs, double background = 0);

  /// `size` is 1 to `largest` grains. NaN if no crystallite of any size was counted.
  double delta_rho(std::int32_t size) const;
  std::optional<double> delta_rho_error(std::int32_t size) const;  ///< bootstrap over runs

  /// The size at which delta_rho rises through zero. For each such size, the excess (growing minus
  /// shrinking crystallites) is summed over all larger sizes. If there are several such sizes, the
  /// one with the largest sum is returned. Empty in three cases: there are fewer than
  /// least_bootstrap_runs runs; no such sum is positive; or delta_rho > 0 at size 1, and the sum
  /// over all sizes is at least as large as each of these sums. The interval comes from the
  /// bootstrap; an end of the interval is infinite if too many samples have no critical size.
  std::optional<Estimate> critical_size() const;
  /// The size s for which the excess, summed over all sizes of at least s grains, is largest. At s
  /// the monotone (isotonic) fit of the unsmoothed delta_rho crosses zero (M. Ayer et al., Ann.
  /// Math. Stat. 26, 641 (1955)). This size serves as a check of critical_size(), which is more
  /// precise.
  std::optional<Estimate> monotone_critical_size() const;
  /// 90 % interval of the critical size in repeated studies, each with `runs` runs.
  Interval repeated_critical_size(std::size_t runs) const;

 private:
  /// One row for each size; enum Column in growth.cpp names the columns. The sums of several runs
  /// can be added.
  using Sums = Eigen::Array<double, largest, 6>;
  std::vector<Sums> runs_;

  Sums over(std::span<const std::size_t> selection) const;
};

/// Adds columns for a size, the ends of its interval and its standard error, all in grains.
void add_size_columns(const std::string& name, std::vector<TableColumn>& columns);
/// Adds the values for the columns of add_size_columns(); empty cells if there is no estimate.
void add_size(const std::optional<Estimate>& size, TableRow& row);
/// The chart point that shows `size` at x. Its y_error is the standard error of the size.
ChartPoint point_of(double x, const Estimate& size);

}  // namespace shearcell
