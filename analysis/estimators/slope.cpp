// SPDX-License-Identifier: GPL-3.0-or-later
// The slope of one number per run versus another column, by maximum likelihood (censored.hpp).
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "analysis/estimators.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

std::string words_of_slope(const ClaimSpec& claim) {
  return fmt::format("change of {} with {}", number_of_the_run.scalar(claim).name, claim.against);
}

/// x is the value of the column `against` at the first checkpoint of each run.
Verdict decide_slope(const ClaimSpec& claim, const Claim& stated, RunGroup runs, RunGroup) {
  NumbersOfRuns numbers{number_of_the_run.scalar(claim)};
  numbers.entered = entered_with({"x", "value", "missing"});
  const NumberColumn against(claim.against);
  std::vector<CensoredValue> values;
  std::vector<double> at;
  std::set<std::string> variants;
  for (const FrameRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    const double x = against(*run, &run->checkpoints.front());
    if (!std::isfinite(x)) continue;
    const CensoredValue value = numbers.take(*run, numbers.scalar.of(*run), {x});
    if (!std::isfinite(value.value)) continue;
    values.push_back(value);
    at.push_back(x);
    variants.insert(run->place.variant);
  }
  std::string note =
      fmt::format("{} of {} runs in {} have a value", values.size() - numbers.censored, runs.size(),
                  counted(variants.size(), "variant"));
  numbers.note_missing(note);
  const bool enough = is_enough(values.size(), runs.size());
  if (!enough) add_note(note, many_left_out);
  std::optional<Estimate> estimate;
  if (variants.size() > 1 && enough) estimate = censored_slope(values, at, stated.level);
  Verdict verdict = decide(stated, words_of_slope(claim), estimate, values.size(), std::move(note),
                           std::move(numbers.entered));
  verdict.censored = numbers.censored;
  return verdict;
}

}  // namespace

const Estimator slope_against = {
    .name = "slope",
    .meaning =
        "slope of a line fitted to all runs; each run gives one point: x is its first value of "
        "`against`, y is its value of `compare`",
    .key = "against",
    .of_run = true,
    .over_variants = true,
    .one_side = true,
    .compares_variants = true,
    .decide = decide_slope,
    .words = words_of_slope};

}  // namespace shearcell
