// SPDX-License-Identifier: GPL-3.0-or-later
// The growth of a column in each run: the slope of a straight line through its checkpoints.
#include <fmt/format.h>

#include "analysis/estimators.hpp"

namespace shearcell {

const Estimator slope_over_cycles = {
    .name = "slope_over_cycles",
    .meaning = "least-squares slope per cycle, from the checkpoints in the range `cycles`",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) -> Scalar {
      const auto first = static_cast<double>(claim.cycles->at(0));
      const auto last = static_cast<double>(claim.cycles->at(1));
      const auto of = [=, number = NumberColumn(claim.compare)](const FrameRun& run) {
        return at_cycles(run, number, first, last, least_squares_slope);
      };
      return {fmt::format("growth of {} per cycle over cycles {} to {}",
                          words_of_column(claim.compare), first, last),
              fmt::format("cycles {} to {}", first, last), of};
    }};

}  // namespace shearcell
