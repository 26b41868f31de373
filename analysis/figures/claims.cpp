// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "analysis/agreement.hpp"
#include "analysis/binning.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/onset.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

/// `compare` gives nothing for two curves that do not reach what the claim is about.
Verdict worst_pair(
    std::span<const Curve> curves, std::string claim, const std::string& missing,
    std::size_t together,
    const std::function<std::optional<CurveDifference>(const Curve&, const Curve&)>& compare) {
  Verdict verdict{std::move(claim),
                  "difference of the worst pair of curves, root mean square in standard errors",
                  std::nullopt,
                  std::nullopt,
                  Ruling::too_few_runs,
                  missing};
  const std::size_t pairs = curves.empty() ? 0 : curves.size() * (curves.size() - 1) / 2;
  double worst = -1;
  bool all = pairs > 0;
  for (std::size_t a = 0; a < curves.size(); ++a) {
    for (std::size_t b = a + 1; b < curves.size(); ++b) {
      const std::optional<CurveDifference> found = compare(curves[a], curves[b]);
      if (!found || !found->rms) {
        all = false;
        continue;
      }
      const double limit = limit_of_agreement(found->freedom, pairs * together);
      if (*found->rms / limit <= worst) continue;
      worst = *found->rms / limit;
      verdict.value = found->rms;
      verdict.limit = limit;
      verdict.note = fmt::format("{} and {}, {} points, {} degrees of freedom", curves[a].variant,
                                 curves[b].variant, found->points, found->freedom);
    }
  }
  if (worst >= 1) {
    verdict.ruling = Ruling::fail;
  } else if (all) {
    verdict.ruling = Ruling::pass;
  } else if (worst >= 0) {
    verdict.note += "; " + missing;
  }
  return verdict;
}

std::optional<CurveDifference> compare_phi(const Curve& a, const Curve& b, std::int64_t until) {
  std::map<std::int64_t, const CurvePoint*> second;
  for (const CurvePoint& point : b.points) second[point.cycle] = &point;
  std::vector<ComparedPoint> points;
  bool reached = false;
  for (const CurvePoint& point : a.points) {
    const auto other = second.find(point.cycle);
    if (point.cycle < 1 || point.cycle > until || other == second.end()) continue;
    points.push_back({over(point, &Measures::phi), over(*other->second, &Measures::phi)});
    reached = reached || (point.cycle == until &&
                          std::min(points.back().a.runs, points.back().b.runs) >= runs_to_tell);
  }
  if (!reached) return std::nullopt;
  constexpr double resolution = 1e-6;  // of phi: rounding, and far below any error over runs
  return difference(points, resolution);
}

/// One grain of the smallest packing [%].
double one_grain_percent(const Curve& curve) {
  std::size_t least = 0;
  for (const Measures* measures : curve.points.front().runs) {
    least = least == 0 ? measures->interior_grains : std::min(least, measures->interior_grains);
  }
  return least == 0 ? 100 : 100 / static_cast<double>(least);
}

std::optional<CurveDifference> compare_crystallinity(const Curve& a, const Curve& b) {
  constexpr double crystallized_percent = 1;
  constexpr std::size_t least_bins = 3;
  std::map<double, PhiBin> second;
  for (const PhiBin& bin : binned_by_phi(b.runs, &Measures::crystalline_percent)) {
    second[bin.low] = bin;
  }
  std::vector<ComparedPoint> points;
  for (const PhiBin& bin : binned_by_phi(a.runs, &Measures::crystalline_percent)) {
    const auto other = second.find(bin.low);
    if (other == second.end()) continue;
    const RunStatistics& value = other->second.value;
    if (std::max(bin.value.mean.value(), value.mean.value()) < crystallized_percent) continue;
    points.push_back({bin.value, value});
  }
  const CurveDifference found =
      difference(points, std::max(one_grain_percent(a), one_grain_percent(b)));
  if (found.points < least_bins) return std::nullopt;
  return found;
}

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

constexpr double step_of_main_text = 45600;  // steps per cycle: 4.4e-5 s

}  // namespace

Verdict phi_agrees_until(std::span<const Curve> curves, std::int64_t until, std::string claim,
                         std::size_t together) {
  return worst_pair(
      curves, std::move(claim),
      fmt::format("needs two curves of {} runs or more that reach cycle {}", runs_to_tell, until),
      together, [until](const Curve& a, const Curve& b) { return compare_phi(a, b, until); });
}

Verdict crystallinity_agrees(std::span<const Curve> curves, std::string claim) {
  return worst_pair(curves, std::move(claim),
                    fmt::format("needs every two curves to share 3 bins of phi with over 1 % "
                                "crystalline grains and {} runs each",
                                runs_to_tell),
                    1, compare_crystallinity);
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

Verdict overlap_is_small(std::span<const Curve> curves) {
  const Curve* curve = curve_with(curves, step_of_main_text);
  std::optional<double> overlap;
  if (curve != nullptr) overlap = over(curve->points.back(), &Measures::mean_overlap).mean;
  return below("B.4: at 4.4e-5 s the average overlap is less than 1e-3",
               "mean overlap at the last cycle [d]", overlap, 1e-3,
               curve == nullptr ? "no run has that time step" : "");
}

std::vector<Verdict> wall_verdicts(std::span<const Curve> curves) {
  const Curve* rough = curve_with(curves, "rough");
  std::vector<Verdict> verdicts = {
      early_verdict(curve_with(curves, "smooth"), true,
                    "smooth walls: more than 20 % crystalline by cycle 20"),
      early_verdict(rough, false, "rough walls: less than 20 % crystalline by cycle 20"),
      bulk_verdict(rough)};
  if (rough != nullptr) {
    const double grains = number_of(*rough->runs.front(), "grains");
    if (published_interior(grains)) {
      verdicts.push_back(interior_is_published(grains, rough->runs));
    }
  }
  return verdicts;
}

}  // namespace shearcell
