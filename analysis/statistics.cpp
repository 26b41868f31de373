// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/statistics.hpp"

#include <cmath>

namespace shearcell {

RunStatistics over_runs(std::span<const double> values) {
  RunStatistics result;
  double sum = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++result.runs;
  }
  if (result.runs == 0) return result;
  const auto n = static_cast<double>(result.runs);
  const double mean = sum / n;
  result.mean = mean;
  if (result.runs < 2) return result;
  double squares = 0;
  for (const double value : values) {
    if (std::isfinite(value)) squares += (value - mean) * (value - mean);
  }
  result.standard_error = std::sqrt(squares / (n * (n - 1)));
  return result;
}

}  // namespace shearcell
