// SPDX-License-Identifier: GPL-3.0-or-later
// Do crystallites of a size grow or shrink, and from which size on do they grow? Supplement C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// How many crystallites of one size grew and shrank.
struct GrowthCount {
  std::size_t grew = 0;      ///< more than half of the grains are in larger crystallites
  std::size_t shrank = 0;    ///< more than half are in smaller ones, or in none
  std::size_t vanished = 0;  ///< of those that shrank: no more than half are in smaller ones
  /// Of those that grew: of the crystallite that has most of their grains, more grains were in
  /// another crystallite before, which was larger.
  std::size_t absorbed = 0;

  bool operator==(const GrowthCount&) const = default;
};

/// By size in grains; has every size that was followed.
using GrowthBySize = std::map<std::int32_t, GrowthCount>;

/// Follows every crystallite of `now` to `later` and counts it.
void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts);

/// All pairs of checkpoints of a run that are `cycles` apart, from every cycle on.
GrowthBySize growth_of(const FigureRun& run, std::int64_t cycles);

struct GrowthRate {
  double size = 0;          ///< geometric mean over crystallites; of one size, that up to rounding
  std::size_t counted = 0;  ///< grew + shrank; the others do not enter the probabilities
  double grow = 0;          ///< rho_g = grew / counted
  double shrink = 0;        ///< rho_s = shrank / counted
  /// Binomial, that of rho_s too: sqrt((grew + 1) (shrank + 1) / ((counted + 2)^2 (counted + 3))),
  /// the standard deviation of rho_g given the counts, which is sqrt(rho_g rho_s / counted) for
  /// many and not zero when all grew.
  double grow_error = 0;
  double delta = 0;        ///< delta_rho = rho_g - rho_s
  double delta_error = 0;  ///< twice grow_error, since rho_g + rho_s = 1
};

/// Over all runs, in bins of sizes: each bin takes sizes, from the smallest on, until it has at
/// least `least_counted` crystallites. By default a bin is one size. The last bin is left out if it
/// has fewer.
std::vector<GrowthRate> growth_rates(std::span<const GrowthBySize> runs,
                                     std::size_t least_counted = 1);

/// Larger crystallites are left out of the fit: their growth ends when the cell is one crystal.
/// [choice]
inline constexpr std::int32_t largest_size_fitted = 100;

/// Whether crystallites that vanished (GrowthCount) count as shrinking. The supplement speaks only
/// of crystallites that become smaller. [choice]: they do.
enum class Vanished { shrank, left_out };

/// Logistic regression, P(grow) = 1 / (1 + exp(-slope (ln size - ln size_0))), by maximum
/// likelihood (D. R. Cox, J. R. Stat. Soc. B 20, 215 (1958)).
struct GrowthFit {
  double intercept = 0;
  double slope = 0;

  double delta_rho(double size) const;          ///< 2 P(grow) - 1
  std::optional<double> critical_size() const;  ///< exp(-intercept / slope); none for slope <= 0
};

/// None if all grew or all shrank, or if there is one size only.
std::optional<GrowthFit> fit_growth(std::span<const GrowthBySize> runs);

/// Over runs; the interval is the bootstrap's with runs as its unit, since one crystallite is
/// followed over many cycles. None for fewer than least_bootstrap_runs, if the fit has no critical
/// size, or if that is less than a grain or more than the largest size that was fitted.
std::optional<Estimate> critical_size(std::span<const GrowthBySize> runs,
                                      Vanished vanished = Vanished::shrank);

/// The same without an assumed curve: the smallest size from which on delta_rho > 0, if delta_rho
/// may only rise with size (M. Ayer et al., Ann. Math. Stat. 26, 641 (1955)). Interval and sizes as
/// of critical_size(); none if all sizes grow, or none does.
std::optional<Estimate> monotone_critical_size(std::span<const GrowthBySize> runs);

/// The fitted delta_rho at each size and its interval, which ends at -1 and 1 where many selections
/// of runs have no fit.
std::vector<std::optional<Estimate>> fitted_delta_rho(std::span<const GrowthBySize> runs,
                                                      std::span<const double> sizes);

}  // namespace shearcell
