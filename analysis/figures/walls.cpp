// SPDX-License-Identifier: GPL-3.0-or-later
// Rough and smooth walls: smooth walls nucleate crystals at once, so only rough ones let grains
// crystallize homogeneously. Not in the supplement, which says that crystallites appear away from
// the walls (E).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

constexpr std::int64_t early = 20;
constexpr double much_percent = 20;

/// The largest percentage of each run up to cycle `early`; only runs that get there.
std::vector<double> early_percentages(const Curve& curve) {
  std::vector<double> found;
  for (const FigureRun* run : curve.runs) {
    double most = std::nan("");
    bool reached = false;
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      if (checkpoint.cycle > early) continue;
      most = std::fmax(most, checkpoint.measures.crystalline_percent);
      reached = reached || checkpoint.cycle == early;
    }
    if (reached || most > much_percent) found.push_back(most);
  }
  return found;
}

Verdict early_verdict(const Curve* curve, bool much, std::string claim) {
  const std::vector<double> values =
      curve == nullptr ? std::vector<double>() : early_percentages(*curve);
  Verdict verdict{
      std::move(claim),       "largest percentage crystalline by cycle 20, mean over runs [%]",
      over_runs(values).mean, much_percent,
      Ruling::too_few_runs,   fmt::format("{} runs reach that cycle", values.size())};
  if (verdict.value) {
    verdict.ruling = (*verdict.value > much_percent) == much ? Ruling::pass : Ruling::fail;
  }
  return verdict;
}

}  // namespace

FigureResult figure_walls(std::span<const FigureRun> runs) {
  static const std::vector<CurveStyle> styles = {{"rough", "rough walls", "#000000", 5},
                                                 {"smooth", "smooth walls", "#d62728", 7}};
  const std::vector<Curve> curves = curves_of(runs, "walls", styles);
  return {{phi_against_cycle("walls_a", curves), crystallinity_against_cycle("walls_b", curves),
           crystallinity_against_phi("walls_c", curves)},
          {early_verdict(curve_with(curves, "smooth"), true,
                         "smooth walls: more than 20 % crystalline by cycle 20"),
           early_verdict(curve_with(curves, "rough"), false,
                         "rough walls: less than 20 % crystalline by cycle 20")}};
}

}  // namespace shearcell
