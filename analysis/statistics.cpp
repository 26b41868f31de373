// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/statistics.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.hpp"

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

std::vector<double> bootstrap_values(std::size_t runs, const RunStatistic& statistic) {
  std::vector<std::size_t> selection(runs);
  std::vector<double> values;
  for (std::uint32_t s = 0; s < bootstrap_selections; ++s) {
    for (std::size_t k = 0; k < runs; ++k) {
      const double u = uniform_pair({s, static_cast<std::uint32_t>(k), 0, 0}, 0)[0];
      selection[k] = static_cast<std::size_t>(u * static_cast<double>(runs));
    }
    const std::optional<double> value = statistic(selection);
    if (value && std::isfinite(*value)) values.push_back(*value);
  }
  return values;
}

std::optional<double> bootstrap_error(std::size_t runs, const RunStatistic& statistic) {
  if (runs < 2) return std::nullopt;
  const std::vector<double> values = bootstrap_values(runs, statistic);
  if (values.size() < bootstrap_selections / 2) return std::nullopt;
  const RunStatistics found = over_runs(values);
  const auto n = static_cast<double>(runs);
  return found.standard_error.value() * std::sqrt(static_cast<double>(found.runs) * n / (n - 1));
}

}  // namespace shearcell
