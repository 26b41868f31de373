// SPDX-License-Identifier: GPL-3.0-or-later
// The change of a column between two cycles of a shear, or between two steps of a stiffening.
#include <fmt/format.h>

#include "analysis/estimators.hpp"

namespace shearcell {
namespace {

Scalar between_cycles(const ClaimSpec& claim, const char* words,
                      double (*change)(double first, double last)) {
  const auto first = static_cast<double>(claim.cycles->at(0));
  const auto last = static_cast<double>(claim.cycles->at(1));
  const auto of = [=, number = NumberColumn(claim.compare)](const FrameRun& run) -> RunValue {
    const CheckpointMeasures *begin = checkpoint_at(run, first), *end = checkpoint_at(run, last);
    if (run.checkpoints.empty() || run.checkpoints.back().cycle < last) {
      return {0, Missing::too_short};
    }
    if (begin == nullptr || end == nullptr) return {0, Missing::checkpoint};
    return measured(change(number(run, begin), number(run, end)));
  };
  const std::string reach = fmt::format("cycles {} and {}", first, last);
  return {fmt::format("{} of {} from cycle {} to {}", words, words_of_column(claim.compare), first,
                      last),
          reach, of};
}

}  // namespace

const Estimator change_over_cycles = {
    .name = "change",
    .meaning = "value at the last cycle of `cycles` minus value at the first cycle",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) {
      return between_cycles(claim, "change",
                            [](double first, double last) { return last - first; });
    }};

const Estimator relative_fall = {
    .name = "relative_fall",
    .meaning = "1 - (value at the last cycle of `cycles`) / (value at the first cycle of `cycles`)",
    .key = "cycles",
    .scalar = [](const ClaimSpec& claim) {
      return between_cycles(claim, "relative fall",
                            [](double first, double last) { return 1 - last / first; });
    }};

}  // namespace shearcell
