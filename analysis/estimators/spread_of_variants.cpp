// SPDX-License-Identifier: GPL-3.0-or-later
// The standard deviation of the true means of the variants. If its upper limit is below the
// margin, the swept parameters hardly change the number.
#include <fmt/format.h>

#include <limits>
#include <map>

#include "analysis/estimators.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

std::string words_of_spread(const ClaimSpec& claim) {
  return "standard deviation between variants of " + estimator_by_keys(claim).scalar(claim).name;
}

Verdict decide_spread(const ClaimSpec& claim, const Claim& stated, RunGroup runs, RunGroup) {
  NumbersOfRuns numbers{estimator_by_keys(claim).scalar(claim)};
  std::map<std::string, std::vector<const FrameRun*>> variants;
  for (const FrameRun* run : runs) variants[run->place.variant].push_back(run);
  std::vector<std::vector<double>> groups;
  std::size_t with_number = 0;
  for (const auto& [variant, members] : variants) {
    std::vector<double> values;
    for (const auto& [packing, mean] : numbers.take(members)) {
      if (!mean.censored) values.push_back(mean.value);
    }
    with_number += values.size();
    if (!values.empty()) groups.push_back(std::move(values));
  }
  std::string note = runs.empty()
                         ? std::string(no_group)
                         : fmt::format("{} independent values from {} runs of {}", with_number,
                                       runs.size(), counted(groups.size(), "variant"));
  std::optional<Estimate> estimate;
  const std::string why_not = numbers.why_not();
  add_note(note, why_not);
  if (const auto found = variance_between(groups, stated.level); found && why_not.empty()) {
    // The spread is NaN: the number of runs that would decide the claim is unknown.
    estimate = Estimate{.value = found->value,
                        .interval = {0, found->upper_limit},
                        .runs = with_number / groups.size(),
                        .spread = std::numeric_limits<double>::quiet_NaN()};
    add_note(note,
             fmt::format("variance ratio F = {:.3g}; the interval extends from 0 to the upper "
                         "{:.3g} % confidence limit",
                         found->f, 50 * (1 + stated.level)));
  }
  if (!estimate && why_not.empty()) {
    add_note(note, "at least two variants are needed, and one of them needs two values or more");
  }
  return decide(stated, words_of_spread(claim), estimate,
                with_number / std::max<std::size_t>(1, groups.size()), std::move(note),
                std::move(numbers.entered), Counted::runs_per_variant);
}

}  // namespace

const Estimator spread_of_variants = {
    .name = "spread_of_variants",
    .meaning = "standard deviation of the true means of the variants, by analysis of variance",
    .of_run = std::nullopt,
    .over_variants = true,
    .one_side = true,
    .compares_variants = true,
    .decide = decide_spread,
    .words = words_of_spread};

}  // namespace shearcell
