// SPDX-License-Identifier: GPL-3.0-or-later
// Do crystallites of a size grow or shrink? Supplement C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "analysis/crystallite_map.hpp"
#include "analysis/figure.hpp"

namespace shearcell {

/// What became of the crystallites of one size.
struct GrowthCount {
  std::size_t grew = 0;       ///< more than half of the grains are in larger crystallites
  std::size_t shrank = 0;     ///< more than half are in smaller ones, or in none
  std::size_t same = 0;       ///< more than half are in crystallites of the same size
  std::size_t undecided = 0;  ///< none of these, as when half went up and half down
  std::size_t vanished = 0;   ///< of those that shrank: no more than half are in smaller ones
};

/// By size in grains.
using GrowthBySize = std::map<std::int32_t, GrowthCount>;

/// Follows every crystallite of `now` to `later` and adds what became of it.
void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts);

/// All pairs of checkpoints of a run that are `cycles` apart, from every cycle on.
GrowthBySize growth_of(const FigureRun& run, std::int64_t cycles);

struct GrowthRate {
  std::int32_t size = 0;
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

/// Over all runs, by size; sizes of which none was counted are left out.
std::vector<GrowthRate> growth_rates(std::span<const GrowthBySize> runs);

}  // namespace shearcell
