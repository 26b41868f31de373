// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and standard error over independent runs.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

namespace shearcell {

struct RunStatistics {
  std::size_t runs = 0;
  std::optional<double> mean;            ///< none for no run
  std::optional<double> standard_error;  ///< sqrt(sum (x - mean)^2 / (n (n - 1))); none for n < 2
};

/// One value per run. Values that are not finite are left out and not counted.
RunStatistics over_runs(std::span<const double> values);

/// Standard error of what `statistic` computes from a selection of runs, by the bootstrap: the
/// standard deviation over 1000 selections of `runs` runs, drawn with replacement, times
/// sqrt(runs / (runs - 1)), so that the error of a mean is that of over_runs(). Random numbers
/// are counted, so the same input gives the same error. Selections without a finite statistic are
/// left out; none when that leaves fewer than half, or for fewer than two runs.
std::optional<double> bootstrap_error(
    std::size_t runs,
    const std::function<std::optional<double>(std::span<const std::size_t>)>& statistic);

}  // namespace shearcell
