// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of each run that follow from its checkpoints at the whole cycles in the range `cycles`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/estimators.hpp"

namespace shearcell {
namespace {

using Points = std::span<const std::pair<double, double>>;  // cycle, value

/// The value of `statistic` for each run. It is defined if the run has a checkpoint at each cycle
/// of the range or, if `ends` is true, at the first and the last cycle. `name` and `cycles`
/// become Scalar::name and Scalar::reach.
Scalar over_cycles(const ClaimSpec& claim, std::string name, std::string cycles,
                   double (*statistic)(Points), bool ends = false) {
  const auto first = static_cast<double>(claim.cycles->at(0));
  const auto last = static_cast<double>(claim.cycles->at(1));
  const auto of = [=, column = NumberColumn(claim.compare)](const FrameRun& run) -> RunValue {
    std::vector<std::pair<double, double>> points;
    for (const CheckpointMeasures& checkpoint : run.checkpoints) {
      const double cycle = checkpoint.cycle;
      if (std::floor(cycle) != cycle || cycle < first || cycle > last) continue;
      if (ends && cycle != first && cycle != last) continue;
      points.emplace_back(cycle, column(run, &checkpoint));
    }
    const double needed = ends ? 2 : last - first + 1;
    if (static_cast<double>(points.size()) == needed) return measured(statistic(points));
    const double end = run.checkpoints.empty() ? 0 : run.checkpoints.back().cycle;
    return {0, std::max(run.end, end) < last ? Missing::too_short : Missing::checkpoint};
  };
  return {std::move(name), std::move(cycles), of};
}

Scalar mean_of_points(const ClaimSpec& claim) {
  const auto [first, last] = *claim.cycles;
  const std::string column = words_of_column(claim.compare);
  const bool one = first == last;
  return over_cycles(
      claim,
      one ? fmt::format("{} at cycle {}", column, last)
          : fmt::format("{}, mean over cycles {} to {}", column, first, last),
      one ? fmt::format("cycle {}", last) : fmt::format("cycles {} to {}", first, last),
      [](Points points) {
        double sum = 0;
        for (const auto& [cycle, value] : points) sum += value;
        return sum / static_cast<double>(points.size());
      });
}

/// `change` is a function of the points at the first and the last cycle.
Scalar between_cycles(const ClaimSpec& claim, const char* words, double (*change)(Points)) {
  const auto [first, last] = *claim.cycles;
  return over_cycles(claim,
                     fmt::format("{} of {} from cycle {} to {}", words,
                                 words_of_column(claim.compare), first, last),
                     fmt::format("cycles {} and {}", first, last), change, true);
}

}  // namespace

const Estimator mean_over_cycles = {
    .name = "mean_over_cycles",
    .meaning = "mean over the checkpoints within `cycles`, or the value at `at_cycle`",
    .key = "cycles",
    .scalar = mean_of_points};

const Estimator change_over_cycles = {
    .name = "change",
    .meaning = "value at the last cycle of `cycles` minus value at the first cycle",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) {
      return between_cycles(claim, "change",
                            [](Points p) { return p.back().second - p.front().second; });
    }};

const Estimator relative_fall = {
    .name = "relative_fall",
    .meaning = "1 - (value at the last cycle of `cycles`) / (value at the first cycle of `cycles`)",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) {
      return between_cycles(claim, "relative fall",
                            [](Points p) { return 1 - p.back().second / p.front().second; });
    }};

const Estimator slope_over_cycles = {
    .name = "slope_over_cycles",
    .meaning = "least-squares slope per cycle, from the checkpoints in the range `cycles`",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) {
      const auto [first, last] = *claim.cycles;
      return over_cycles(claim,
                         fmt::format("growth of {} per cycle over cycles {} to {}",
                                     words_of_column(claim.compare), first, last),
                         fmt::format("cycles {} to {}", first, last), least_squares_slope);
    }};

}  // namespace shearcell
