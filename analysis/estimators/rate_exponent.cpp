// SPDX-License-Identifier: GPL-3.0-or-later
// The exponent of the rate of nucleation as a function of a number of grains (nucleation.hpp).
#include <fmt/format.h>

#include "analysis/estimators.hpp"
#include "analysis/nucleation.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

std::string words_of_exponent(const ClaimSpec& claim) {
  return fmt::format("exponent of the rate against {}", claim.against);
}

/// Compares the exponent with the published exponent, or with 0 if the claim has no published
/// exponent. Throws UsageError if `against` is neither interior_grains nor core_grains.
Verdict decide_exponent(const ClaimSpec& claim, const Claim& stated, RunGroup runs, RunGroup) {
  const Region region = claim.against == grains_of(Region::core) ? Region::core : Region::interior;
  if (claim.against != grains_of(region)) {
    throw UsageError(fmt::format("claim {}: `against` must be {} or {}", claim.id,
                                 grains_of(Region::interior), grains_of(Region::core)));
  }
  Table entered =
      entered_with({"amplitude_rad", "grains", "phi", "cycles", "grain_cycles", "onsets"});
  std::size_t onsets = 0;
  for (const FrameRun* run : runs) {
    for (const auto& [step, one] : exposures_of(*run, region, rate_step)) {
      onsets += one.onsets;
      enter(*run,
            {number_of(*run, "amplitude_rad"), number_of(*run, "grains"), one.phi, one.cycles,
             one.grain_cycles, one.onsets},
            entered);
    }
  }
  const double published = claim.published ? claim.published->value.value_or(0) : 0;
  std::optional<Estimate> estimate = size_exponent(runs, region, stated.level);
  if (estimate) estimate = mapped(*estimate, [&](double exponent) { return exponent - published; });
  return decide(stated, fmt::format("{} minus {}", words_of_exponent(claim), published), estimate,
                estimate ? estimate->runs : runs.size(),
                estimate ? fmt::format("maximum likelihood, {} onsets", onsets)
                         : "too few data: at least three runs, and onsets at equal phi in cells of "
                           "two sizes, are needed",
                std::move(entered));
}

}  // namespace

const Estimator rate_exponent = {.name = "rate_exponent",
                                 .meaning =
                                     "exponent a of the power law n^a for the rate of onsets at "
                                     "equal phi and amplitude; `against` selects n: "
                                     "interior_grains or core_grains",
                                 .key = "against",
                                 .of_run = true,
                                 .over_variants = true,
                                 .one_side = true,
                                 .compares_variants = true,
                                 .decide = decide_exponent,
                                 .words = words_of_exponent};

}  // namespace shearcell
