// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/estimators.hpp"

namespace shearcell {

const Estimator number_of_the_run = {
    .name = "number_of_run",
    .meaning =
        "a measure of the whole run, such as `onset_size_phi`, or an expression of such measures",
    .of_run = true,
    .scalar = [](const ClaimSpec& claim) -> Scalar {
      const Measure* measure = find_measure(claim.compare, MeasureKind::run);
      return {measure != nullptr ? std::string(measure->words) : claim.compare,
              reach_of(claim.compare), [number = NumberColumn(claim.compare)](const FrameRun& run) {
                return number.of_run(run);
              }};
    }};

}  // namespace shearcell
