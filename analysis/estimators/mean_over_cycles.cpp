// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/estimators.hpp"

namespace shearcell {

RunValue at_cycles(const FrameRun& run, const NumberColumn& column, double first, double last,
                   PointStatistic statistic) {
  std::vector<std::pair<double, double>> points;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const double cycle = checkpoint.cycle;
    if (std::floor(cycle) != cycle || cycle < first || cycle > last) continue;
    points.emplace_back(cycle, column(run, &checkpoint));
  }
  if (static_cast<double>(points.size()) == last - first + 1) return measured(statistic(points));
  const double end = run.checkpoints.empty() ? 0 : run.checkpoints.back().cycle;
  return {0, std::max(run.end, end) < last ? Missing::too_short : Missing::checkpoint};
}

Scalar over_cycles(const std::string& name, const std::string& column, double first, double last) {
  const auto of = [number = NumberColumn(column), first, last](const FrameRun& run) {
    return at_cycles(run, number, first, last, [](auto points) {
      double sum = 0;
      for (const auto& [cycle, value] : points) sum += value;
      return sum / static_cast<double>(points.size());
    });
  };
  if (first == last) {
    return {fmt::format("{} at cycle {}", name, last), fmt::format("cycle {}", last), of};
  }
  return {fmt::format("{}, mean over cycles {} to {}", name, first, last),
          fmt::format("cycles {} to {}", first, last), of};
}

const Estimator mean_over_cycles = {
    .name = "mean_over_cycles",
    .meaning = "mean over the checkpoints within `cycles`, or the value at `at_cycle`",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) {
      return over_cycles(words_of_column(claim.compare), claim.compare,
                         static_cast<double>(claim.cycles->at(0)),
                         static_cast<double>(claim.cycles->at(1)));
    }};

}  // namespace shearcell
