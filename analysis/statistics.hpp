// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and standard error over independent runs; bootstrap.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace shearcell {

struct RunStatistics {
  std::size_t runs = 0;
  std::optional<double> mean;            ///< none without runs
  std::optional<double> standard_error;  ///< sqrt(sum (x - mean)^2 / (n (n - 1))); none for n < 2
};

/// One value per run. Values that are not finite are left out and not counted.
RunStatistics over_runs(std::span<const double> values);

/// Values of `statistic` over bootstrap_selections selections of `runs` runs, drawn with
/// replacement by core's counter-based generator: the same input gives the same values. Selections
/// without a finite value are left out.
inline constexpr std::size_t bootstrap_selections = 1000;
using RunStatistic = std::function<std::optional<double>(std::span<const std::size_t>)>;
std::vector<double> bootstrap_values(std::size_t runs, const RunStatistic& statistic);

/// Standard error of a statistic: standard deviation of the bootstrap values times
/// sqrt(runs / (runs - 1)), so that the error of a mean is that of over_runs(). None for fewer than
/// two runs, or if fewer than half of the selections have a value.
std::optional<double> bootstrap_error(std::size_t runs, const RunStatistic& statistic);

}  // namespace shearcell
