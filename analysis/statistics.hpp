// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and standard error over independent runs.
#pragma once

#include <cstddef>
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

}  // namespace shearcell
