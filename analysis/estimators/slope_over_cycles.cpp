// SPDX-License-Identifier: GPL-3.0-or-later
// The growth of a column in each run: the slope of a straight line through its checkpoints.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/estimators.hpp"

namespace shearcell {

const Estimator slope_over_cycles = {
    .name = "slope_over_cycles",
    .meaning = "least-squares slope against the cycle, over the checkpoints of `cycles`",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) -> Scalar {
      const auto first = static_cast<double>(claim.cycles->at(0));
      const auto last = static_cast<double>(claim.cycles->at(1));
      const auto of = [=, number = NumberColumn(claim.compare)](const FrameRun& run) -> RunValue {
        std::vector<std::pair<double, double>> points;
        for (const CheckpointMeasures& checkpoint : run.checkpoints) {
          const double cycle = checkpoint.cycle;
          if (std::floor(cycle) != cycle || cycle < first || cycle > last) continue;
          points.emplace_back(cycle, number(run, &checkpoint));
        }
        const double end = run.checkpoints.empty() ? 0 : run.checkpoints.back().cycle;
        if (std::max(run.end, end) < last) return {0, Missing::too_short};
        if (static_cast<double>(points.size()) != last - first + 1) {
          return {0, Missing::checkpoint};
        }
        return measured(least_squares_slope(points));
      };
      return {fmt::format("growth of {} per cycle over cycles {} to {}",
                          words_of_column(claim.compare), first, last),
              fmt::format("cycles {} to {}", first, last), of};
    }};

}  // namespace shearcell
