// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/estimators.hpp"

namespace shearcell {
namespace {

Scalar scalar_of_run(const ClaimSpec& claim) {
  if (const Measure* measure = find_measure(claim.compare, MeasureKind::run)) {
    return {std::string(measure->words), std::string(measure->reach), measure->of_run};
  }
  // If measures in the expression have no value, the reason for the first of them is returned.
  const auto of = [number = NumberColumn(claim.compare),
                   names = names_in(claim.compare)](const FrameRun& run) {
    for (const std::string& name : names) {
      const Measure* measure = find_measure(name, MeasureKind::run);
      if (measure == nullptr) continue;
      const Missing why = measure->of_run(run).missing;
      if (why != Missing::nothing) return RunValue{0, why};
    }
    return measured(number(run));
  };
  return {claim.compare, claim.compare, of};
}

}  // namespace

const Estimator number_of_the_run = {
    .name = "number_of_run",
    .meaning =
        "a measure of the whole run, such as `onset_size_phi`, or an expression of such measures",
    .of_run = true,
    .scalar = scalar_of_run};

}  // namespace shearcell
