// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/estimators.hpp"

namespace shearcell {

Scalar over_cycles(const std::string& name, const std::string& column, std::int64_t first,
                   std::int64_t last) {
  const auto of = [number = NumberColumn(column), first, last](const FrameRun& run) -> RunValue {
    double sum = 0;
    std::int64_t count = 0;
    for (const CheckpointMeasures& checkpoint : run.checkpoints) {
      const double cycle = checkpoint.cycle;
      if (std::floor(cycle) != cycle || cycle < static_cast<double>(first) ||
          cycle > static_cast<double>(last)) {
        continue;
      }
      sum += number(run, &checkpoint);
      ++count;
    }
    if (count != last - first + 1) {
      const double end = run.checkpoints.empty() ? 0 : run.checkpoints.back().cycle;
      const bool ended = std::max(run.end, end) < static_cast<double>(last);
      return {0, ended ? Missing::too_short : Missing::checkpoint};
    }
    return measured(sum / static_cast<double>(count));
  };
  if (first == last) {
    return {fmt::format("{} at cycle {}", name, last), fmt::format("cycle {}", last), of};
  }
  return {fmt::format("{}, mean over cycles {} to {}", name, first, last),
          fmt::format("cycles {} to {}", first, last), of};
}

const Estimator mean_over_cycles = {
    .name = "mean_over_cycles",
    .meaning = "mean over the checkpoints of `cycles`, or the value at `at_cycle`",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) {
      return over_cycles(words_of_column(claim.compare), claim.compare,
                         static_cast<std::int64_t>(claim.cycles->at(0)),
                         static_cast<std::int64_t>(claim.cycles->at(1)));
    }};

}  // namespace shearcell
