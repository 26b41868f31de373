// SPDX-License-Identifier: GPL-3.0-or-later
// The slope of a number of the run against another column, by least squares over the runs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/estimators.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

std::string words_of_slope(const ClaimSpec& claim) {
  return fmt::format("change of {} with {}", number_of_the_run.scalar(claim).name, claim.against);
}

/// `against` is taken at the first checkpoint of each run. The bootstrap draws runs.
Verdict decide_slope(const ClaimSpec& claim, const Claim& stated, RunGroup runs, RunGroup) {
  const Scalar number = number_of_the_run.scalar(claim);
  const NumberColumn against(claim.against);
  std::vector<std::pair<double, double>> points;
  std::set<std::string> variants;
  Table entered = entered_with({"x", "value"});
  for (const FrameRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    const double x = against(*run, &run->checkpoints.front()), y = number.of(*run).or_nan();
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    points.emplace_back(x, y);
    variants.insert(run->place.variant);
    enter(*run, {x, y}, entered);
  }
  const auto slope = [&](std::span<const std::size_t> selection) {
    std::vector<std::pair<double, double>> chosen;
    for (const std::size_t k : selection) chosen.push_back(points[k]);
    return least_squares_slope(chosen);
  };
  return decide(stated, words_of_slope(claim),
                variants.size() < 2 ? std::nullopt : bootstrapped(points.size(), slope),
                points.size(),
                fmt::format("{} of {} runs have it, in {}", points.size(), runs.size(),
                            counted(variants.size(), "variant")),
                std::move(entered));
}

}  // namespace

const Estimator slope_against = {
    .name = "slope",
    .meaning = "slope against the column `against` at each run's first checkpoint",
    .key = "against",
    .decide = decide_slope,
    .words = words_of_slope};

}  // namespace shearcell
