// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/onset.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/published.hpp"

namespace shearcell {
namespace {

struct Point {
  double phi;
  double log_size;
  double cycle;
};

std::vector<Point> points_of(const FigureRun& run) {
  std::vector<Point> points;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const Measures& m = checkpoint.measures;
    if (!std::isfinite(m.phi)) continue;
    const auto size = static_cast<double>(std::max<std::size_t>(1, m.largest_crystallite));
    points.push_back({m.phi, std::log(size), checkpoint.cycle});
  }
  return points;
}

/// Least-squares slope of log_size against phi and the mean cycle, in the window around `phi`.
struct Slope {
  double slope;
  double cycle;
};
std::optional<Slope> slope_at(std::span<const Point> points, double phi) {
  constexpr double least_points = 4;
  double n = 0, x = 0, y = 0, cycle = 0;
  double low = phi, high = phi;
  const auto within = [&](const Point& p) { return std::abs(p.phi - phi) <= slope_window / 2; };
  for (const Point& p : points) {
    if (!within(p)) continue;
    ++n;
    x += p.phi;
    y += p.log_size;
    cycle += p.cycle;
    low = std::min(low, p.phi);
    high = std::max(high, p.phi);
  }
  if (n < least_points || high - low < slope_window / 2) return std::nullopt;
  double xx = 0, xy = 0;
  for (const Point& p : points) {
    if (!within(p)) continue;
    xx += (p.phi - x / n) * (p.phi - x / n);
    xy += (p.phi - x / n) * (p.log_size - y / n);
  }
  return Slope{xy / xx, cycle / n};
}

}  // namespace

double critical_size_for(const FigureRun& run) {
  return published_nearest(number_of(run, "amplitude_rad")).critical_size;
}

RunOnset onset_by_size(const FigureRun& run) {
  const double critical_size = critical_size_for(run);
  const CheckpointMeasures* before = nullptr;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!std::isfinite(checkpoint.measures.phi)) continue;
    const auto size = static_cast<double>(checkpoint.measures.largest_crystallite);
    if (size >= critical_size) {
      if (before == nullptr) return {Observed::before_start, 0, 0};
      const auto smaller = static_cast<double>(before->measures.largest_crystallite);
      const double part = (critical_size - smaller) / (size - smaller);
      return {Observed::yes, std::lerp(before->measures.phi, checkpoint.measures.phi, part),
              std::lerp(before->cycle, checkpoint.cycle, part)};
    }
    before = &checkpoint;
  }
  return {};
}

RunOnset onset_by_slope(const FigureRun& run) {
  const RunOnset by_size = onset_by_size(run);
  if (by_size.observed != Observed::yes) return by_size;
  const std::vector<Point> points = points_of(run);
  const auto [lowest, highest] = std::ranges::minmax(points, {}, &Point::phi);
  constexpr double step = slope_window / 32;
  RunOnset found{Observed::unclear};
  double steepest = 0;
  const auto steps = static_cast<int>((highest.phi - lowest.phi) / step);
  for (int k = 0; k <= steps; ++k) {
    const double phi = lowest.phi + k * step;
    const std::optional<Slope> here = slope_at(points, phi);
    if (!here || here->slope <= steepest) continue;
    steepest = here->slope;
    found = {Observed::yes, phi, here->cycle};
  }
  return found;
}

double RunMeasure::of(const FigureRun& run) const {
  const RunOnset onset = method(run);
  return onset.observed == Observed::yes ? onset.*value : std::nan("");
}

std::span<const RunMeasure> all_run_measures() {
  static constexpr RunMeasure all[] = {{"onset_size_cycle", onset_by_size, &RunOnset::cycle},
                                       {"onset_size_phi", onset_by_size, &RunOnset::phi},
                                       {"onset_slope_phi", onset_by_slope, &RunOnset::phi}};
  return all;
}

const RunMeasure* find_run_measure(std::string_view name) {
  return find_named(all_run_measures(), name);
}

Onset onset(RunGroup runs, OnsetMethod method) {
  Onset result;
  std::vector<double> phi;
  std::vector<double> cycle;
  for (const FigureRun* run : runs) {
    const RunOnset found = method(*run);
    if (found.observed == Observed::never) ++result.never;
    if (found.observed == Observed::before_start) ++result.before_start;
    if (found.observed == Observed::unclear) ++result.unclear;
    if (found.observed != Observed::yes) continue;
    phi.push_back(found.phi);
    cycle.push_back(found.cycle);
  }
  result.phi = over_runs(phi);
  result.cycle = over_runs(cycle);
  result.phi_error = bootstrap_error(phi.size(), [&](std::span<const std::size_t> selection) {
    std::vector<double> selected;
    for (const std::size_t run : selection) selected.push_back(phi[run]);
    return over_runs(selected).mean;
  });
  return result;
}

}  // namespace shearcell
