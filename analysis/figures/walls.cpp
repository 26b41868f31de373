// SPDX-License-Identifier: GPL-3.0-or-later
// Rough and smooth walls: smooth walls nucleate crystals at once, so only rough ones let grains
// crystallize homogeneously. Not in the supplement, which says that crystallites appear away from
// the walls (E).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/onset.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

constexpr std::int64_t early = 20;
constexpr double much_percent = 20;
// Where rough walls let the grains crystallize. The bounds are wide enough for one run of 5200
// grains, whose onsets scatter about 0.646.
constexpr double bulk_before_cycle = 120;
constexpr double bulk_phi_least = 0.640;
constexpr double bulk_phi_most = 0.652;

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

/// What becomes of the rough runs. One that ends early, without a crystallite, tells nothing.
Verdict bulk_verdict(const Curve* curve) {
  std::size_t so = 0, otherwise = 0, censored = 0;
  std::string onsets;
  const std::vector<const FigureRun*> none;
  for (const FigureRun* run : curve == nullptr ? none : curve->runs) {
    const double critical = published_nearest(number_of(*run, "amplitude_rad")).critical_size;
    const RunOnset onset = onset_by_size(*run, critical);
    if (onset.observed == Observed::never) {
      const bool whole =
          !run->checkpoints.empty() && run->checkpoints.back().cycle >= bulk_before_cycle;
      ++(whole ? otherwise : censored);
      continue;
    }
    const bool within = onset.observed == Observed::yes && onset.cycle < bulk_before_cycle &&
                        onset.phi >= bulk_phi_least && onset.phi <= bulk_phi_most;
    ++(within ? so : otherwise);
    if (onset.observed == Observed::yes)
      onsets += fmt::format("; phi = {:.4f} at cycle {:.1f}", onset.phi, onset.cycle);
  }
  std::optional<double> value;
  if (so + otherwise > 0) value = static_cast<double>(otherwise);
  return below(fmt::format("rough walls: a crystallite of the critical size (16 grains at A = "
                           "0.0833 rad) before cycle {}, at phi between {} and {}",
                           bulk_before_cycle, bulk_phi_least, bulk_phi_most),
               "runs that do otherwise", value, 1,
               fmt::format("{} of {} runs do{}; {} end before that cycle without one", so,
                           so + otherwise, onsets, censored));
}

}  // namespace

FigureResult figure_walls(std::span<const FigureRun> runs) {
  static const std::vector<CurveStyle> styles = {{"rough", "rough walls", "#000000", 5},
                                                 {"smooth", "smooth walls", "#d62728", 7}};
  const std::vector<Curve> curves = curves_of(runs, "walls", styles);
  const Curve* rough = curve_with(curves, "rough");
  FigureResult result{
      {phi_against_cycle("walls_a", curves), crystallinity_against_cycle("walls_b", curves),
       crystallinity_against_phi("walls_c", curves)},
      {early_verdict(curve_with(curves, "smooth"), true,
                     "smooth walls: more than 20 % crystalline by cycle 20"),
       early_verdict(rough, false, "rough walls: less than 20 % crystalline by cycle 20"),
       bulk_verdict(rough)}};
  if (rough != nullptr) {
    const double grains = number_of(*rough->runs.front(), "grains");
    if (published_interior(grains)) {
      result.verdicts.push_back(interior_is_published(grains, rough->runs));
    }
  }
  return result;
}

}  // namespace shearcell
