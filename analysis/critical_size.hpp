// SPDX-License-Identifier: GPL-3.0-or-later
// The size above which a crystallite is more likely to grow than to shrink. Supplement C.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/estimate.hpp"
#include "analysis/growth.hpp"

namespace shearcell {

/// Larger crystallites are left out of the fit: their growth ends when the cell is one crystal.
/// [choice]
inline constexpr std::int32_t largest_size_fitted = 100;

/// Crystallites that leave no majority in any crystallite: shrank, or not counted. The supplement
/// names those that become smaller only. [choice]: shrank.
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
std::optional<GrowthFit> fit_growth(std::span<const GrowthBySize> runs,
                                    Vanished vanished = Vanished::shrank);

/// Over runs; the interval is the bootstrap's with runs as its unit, since one crystallite is
/// followed over many cycles. None for fewer than least_runs, or if the fit has no critical size.
std::optional<Estimate> critical_size(std::span<const GrowthBySize> runs,
                                      Vanished vanished = Vanished::shrank);

/// The fitted delta_rho at `size` and its interval.
std::optional<Estimate> fitted_delta_rho(std::span<const GrowthBySize> runs, double size);

/// Sizes low .. high together, for a drawing: mean delta_rho over those that grew or shrank.
struct GrowthBin {
  std::int32_t low = 0;
  std::int32_t high = 0;
  double size = 0;  ///< geometric mean over crystallites
  double delta = 0;
  double delta_error = 0;  ///< as GrowthRate::delta_error
  std::size_t counted = 0;
};

/// From the smallest size on, each bin takes sizes until it has at least `least_counted`
/// crystallites; a rest with fewer is left out.
std::vector<GrowthBin> binned_growth(std::span<const GrowthBySize> runs, std::size_t least_counted);

}  // namespace shearcell
