// SPDX-License-Identifier: GPL-3.0-or-later
// The difference between two sides whose runs also differ in other parameters, such as the
// amplitude. Runs with equal values of these parameters form a stratum. The two sides are compared
// within each stratum, and the differences of all strata are averaged.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/estimators.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// A stratum with n and m runs on the two sides has the weight n m / (n + m). The variances of the
/// means may differ, so t has Welch's degrees of freedom.
Verdict decide_pooled(const ClaimSpec& claim, const Claim& stated, RunGroup a, RunGroup b) {
  NumbersOfRuns numbers{estimator_by_keys(claim).scalar(claim)};
  numbers.entered = entered_with({"stratum", "side", "value", "missing"});
  const RunGroup sides[] = {a, b};
  std::vector<json> others;  // for each run, its parameters except the keys of `between`
  for (const RunGroup side : sides) {
    for (const FrameRun* run : side) {
      json& other = others.emplace_back(run->parameters);
      for (const json& of_side : claim.between) {
        for (const auto& [key, value] : of_side.items()) other.erase(key);
      }
    }
  }
  const std::vector<std::string> keys = varied_keys(others);
  using Side = std::pair<std::vector<const FrameRun*>, std::vector<CensoredValue>>;
  std::map<json, std::array<Side, 2>> strata;
  for (std::size_t k = 0; k < 2; ++k) {
    for (const FrameRun* run : sides[k]) {
      json stratum = json::object();
      for (const std::string& key : keys) stratum[key] = run->parameters.value(key, json());
      auto& [runs, values] = strata[stratum].at(k);
      runs.push_back(run);
      values.push_back(
          numbers.take(*run, numbers.scalar.of(*run), {shearcell::words_of(stratum), k + 1}));
    }
  }
  double weights = 0, sum = 0, variance = 0, fourth = 0;
  std::size_t pooled = 0, censored = 0, all = 0, used = 0, runs[2] = {0, 0};
  for (const auto& [stratum, both] : strata) {
    std::vector<CensoredValue> values[2];
    std::optional<Estimate> mean[2];
    for (std::size_t k = 0; k < 2; ++k) {
      values[k] = over_packings(both.at(k).first, both.at(k).second);
      mean[k] = censored_mean(values[k], stated.level);
    }
    if (both[0].first.empty() || both[1].first.empty()) continue;  // nothing to compare
    const bool usable = mean[0] && mean[1] && std::isfinite(mean[0]->spread + mean[1]->spread);
    for (const auto& [of_side, found] : both) {
      all += found.size();
      used += static_cast<std::size_t>(std::ranges::count_if(
          found, [&](const CensoredValue& v) { return usable && std::isfinite(v.value); }));
    }
    if (!usable) continue;
    ++pooled;
    const double n = static_cast<double>(values[0].size()),
                 m = static_cast<double>(values[1].size()), weight = n * m / (n + m);
    weights += weight;
    sum += weight * (mean[0]->value - mean[1]->value);
    for (std::size_t k = 0; k < 2; ++k) {
      const double count = static_cast<double>(values[k].size());
      const double error = weight * weight * mean[k]->spread * mean[k]->spread / count;
      variance += error;
      fourth += error * error / (count - 1);
      runs[k] += values[k].size();
      censored +=
          static_cast<std::size_t>(std::ranges::count(values[k], true, &CensoredValue::censored));
    }
  }
  std::optional<Estimate> estimate;
  if (variance > 0 && is_enough(used, all)) {
    const double value = sum / weights,
                 t = student_quantile((1 + stated.level) / 2, variance * variance / fourth);
    const double half = t * std::sqrt(variance) / weights;
    estimate = estimate_with(value, {value - half, value + half}, t, std::min(runs[0], runs[1]));
    estimate->groups = 2;
  }
  std::string note = no_group;
  if (!strata.empty()) {
    note = fmt::format(
        "{} and {} runs on the two sides, from {} of {}; the runs of a group differ only in the "
        "compared parameter and the seed, and each side of a group needs at least {} values",
        runs[0], runs[1], pooled, counted(strata.size(), "group"), least_runs);
    numbers.note_missing(note);
    if (!is_enough(used, all)) add_note(note, many_left_out);
  }
  Verdict verdict = decide(stated, "pooled difference in " + numbers.scalar.name, estimate,
                           std::min(runs[0], runs[1]), std::move(note), std::move(numbers.entered),
                           Counted::runs_per_variant);
  verdict.censored = censored;
  return verdict;
}

}  // namespace

const Estimator pooled_difference = {
    .name = "pooled_difference",
    .meaning =
        "difference between the two sides of `between`, averaged over groups of runs that agree in "
        "all parameters that `between` does not name; each side may have several variants",
    .of_run = std::nullopt,
    .over_variants = true,
    .decide = decide_pooled,
    .words = [](const ClaimSpec& claim) { return estimator_by_keys(claim).scalar(claim).name; }};

}  // namespace shearcell
