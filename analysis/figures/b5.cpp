// SPDX-License-Identifier: GPL-3.0-or-later
// The two relaxations: pauses let the grains compact in fewer cycles and leave the curve of
// crystallinity against packing fraction as it is. Supplement B.5, Fig. 5(a) of the main text.
#include <fmt/format.h>
#include <cmath>
#include <map>

#include "analysis/agreement.hpp"
#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

/// Mean over the cycles after the first of phi in one run.
double mean_phi(const FigureRun& run, double last) {
  std::vector<double> phi;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (checkpoint.cycle >= 1 && checkpoint.cycle <= last) phi.push_back(checkpoint.measures.phi);
  }
  return over_runs(phi).mean.value_or(std::nan(""));
}

/// Seeds are compared one by one: both relaxations begin with the same packing.
std::vector<double> paired_gains(const Curve& continuous, const Curve& paused) {
  std::map<std::uint64_t, const FigureRun*> by_seed;
  for (const FigureRun* run : continuous.runs) by_seed[run->seed] = run;
  std::vector<double> gains;
  for (const FigureRun* run : paused.runs) {
    const auto partner = by_seed.find(run->seed);
    if (partner == by_seed.end() || run->checkpoints.empty() ||
        partner->second->checkpoints.empty()) {
      continue;
    }
    const double last =
        std::min(run->checkpoints.back().cycle, partner->second->checkpoints.back().cycle);
    gains.push_back(mean_phi(*run, last) - mean_phi(*partner->second, last));
  }
  return gains;
}

Verdict pauses_compact_faster(std::span<const Curve> curves) {
  Verdict verdict{"B.5: phi grows more rapidly with cycle number for paused shear",
                  "phi(paused) - phi(continuous), mean over cycles and seeds, in standard errors",
                  std::nullopt,
                  std::nullopt,
                  Ruling::too_few_runs,
                  ""};
  const Curve* continuous = curve_with(curves, "continuous");
  const Curve* paused = curve_with(curves, "paused");
  if (continuous == nullptr || paused == nullptr) {
    verdict.note = "one of the relaxations has no run";
    return verdict;
  }
  const RunStatistics gain = over_runs(paired_gains(*continuous, *paused));
  verdict.note = fmt::format("{} pairs of runs", gain.runs);
  if (gain.mean) verdict.note += fmt::format(", difference {:.3g}", *gain.mean);
  if (!gain.standard_error || *gain.standard_error <= 0) return verdict;
  verdict.value = *gain.mean / *gain.standard_error;
  verdict.limit = limit_of_agreement(gain.runs - 1);
  if (gain.runs < runs_to_tell) return verdict;
  if (*verdict.value > *verdict.limit) verdict.ruling = Ruling::pass;
  if (*verdict.value < -*verdict.limit) verdict.ruling = Ruling::fail;
  return verdict;
}

}  // namespace

FigureResult figure_b5(std::span<const FigureRun> runs) {
  static const std::vector<CurveStyle> styles = {
      {"continuous", "continuous shear", "#000000", 5},
      {"paused", "periodically paused shear", "#d62728", 7}};
  const std::vector<Curve> curves = curves_of(runs, "protocol", styles);
  return {{phi_against_cycle("B5a", curves), crystallinity_against_cycle("B5b", curves),
           crystallinity_against_phi("B5c", curves)},
          {pauses_compact_faster(curves),
           crystallinity_agrees(
               curves, "B.5: percentage crystalline against phi is similar for both relaxations")}};
}

}  // namespace shearcell
