// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/onset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/published.hpp"

namespace shearcell {
namespace {

double critical_size_for(const FrameRun& run) {
  return published_nearest(number_of(run, "amplitude_rad")).critical_size;
}

template <OnsetMethod kMethod, double RunOnset::*kValue>
RunValue at_onset(const FrameRun& run) {
  const RunOnset onset = kMethod(run);
  if (onset.missing == Missing::too_short) return {0, Missing::too_short, onset.*kValue};
  return onset.missing == Missing::nothing ? measured(onset.*kValue) : RunValue{0, onset.missing};
}

}  // namespace

RunOnset onset_by_size(const FrameRun& run) {
  const double critical_size = critical_size_for(run);
  double cycle_before = 0, phi_before = std::nan(""), size_before = 0;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const double phi = checkpoint.measures.number("phi");
    if (!std::isfinite(phi)) continue;
    const double size = checkpoint.measures.number("largest_crystallite");
    if (size >= critical_size) {
      if (std::isnan(phi_before)) return {Missing::too_late, 0, 0};
      const double part = (critical_size - size_before) / (size - size_before);
      return {Missing::nothing, std::lerp(phi_before, phi, part),
              std::lerp(cycle_before, checkpoint.cycle, part)};
    }
    cycle_before = checkpoint.cycle, phi_before = phi, size_before = size;
  }
  return {Missing::too_short, phi_before, cycle_before};
}

RunOnset onset_by_slope(const FrameRun& run) {
  const RunOnset by_size = onset_by_size(run);
  if (by_size.missing != Missing::nothing) return by_size;
  struct Point {
    double phi, log_size, cycle;
  };
  std::vector<Point> points;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const double phi = checkpoint.measures.number("phi");
    const double size = std::max(1.0, checkpoint.measures.number("largest_crystallite"));
    if (std::isfinite(phi)) points.push_back({phi, std::log(size), checkpoint.cycle});
  }
  const auto [lowest, highest] = std::ranges::minmax(points, {}, &Point::phi);
  constexpr double step = slope_window / 32;
  RunOnset found{Missing::undefined};
  double steepest = 0;
  const auto steps = static_cast<int>((highest.phi - lowest.phi) / step);
  for (int k = 0; k <= steps; ++k) {
    const double phi = lowest.phi + k * step;
    std::vector<std::pair<double, double>> within;
    double cycle = 0, low = phi, high = phi;
    for (const Point& p : points) {
      if (std::abs(p.phi - phi) > slope_window / 2) continue;
      within.emplace_back(p.phi, p.log_size);
      cycle += p.cycle;
      low = std::min(low, p.phi);
      high = std::max(high, p.phi);
    }
    if (within.size() < 4 || high - low < slope_window / 2) continue;
    const double slope = least_squares_slope(within);
    if (slope <= steepest) continue;
    steepest = slope;
    found = {Missing::nothing, phi, cycle / static_cast<double>(within.size())};
  }
  return found;
}

std::vector<Provider> onset_providers() {
  const auto of_run = [](const char* name, const char* meaning, auto* value, const char* words,
                         bool waits = false) {
    return Measure{.name = name,
                   .unit = "1",
                   .meaning = meaning,
                   .kind = MeasureKind::run,
                   .words = words,
                   .of_run = value,
                   .reach = "the onset",
                   .waits = waits};
  };
  const auto critical = [](const FrameRun& run) { return measured(critical_size_for(run)); };
  using R = RunOnset;
  return {
      {.name = "onsets",
       .measures =
           {of_run("critical_size",
                   "critical size in grains, from the supplement, at the published amplitude "
                   "nearest to that of the run",
                   +critical, "the critical size"),
            of_run("onset_size_cycle",
                   "cycle at which the largest crystallite reaches the critical size: the onset "
                   "by method 1",
                   at_onset<onset_by_size, &R::cycle>, "the cycle of the onset", true),
            of_run("onset_size_phi", "volume fraction at onset_size_cycle, the onset by method 1",
                   at_onset<onset_by_size, &R::phi>, "phi at the onset"),
            of_run("onset_slope_cycle",
                   "cycle at which the logarithm of the size of the largest crystallite rises most "
                   "steeply with phi: the onset by method 2",
                   at_onset<onset_by_slope, &R::cycle>, "the cycle of the onset by method 2"),
            of_run("onset_slope_phi", "volume fraction at onset_slope_cycle, the onset by method 2",
                   at_onset<onset_by_slope, &R::phi>, "phi at the onset")},
       .from = ComputedFrom::history}};
}

}  // namespace shearcell
