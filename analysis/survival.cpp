// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/survival.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

namespace shearcell {
namespace {

/// Runs that still wait just before `cycle`, and events at it.
struct AtRisk {
  double waiting = 0;
  double events = 0;
};
AtRisk at(std::span<const Waiting> runs, double cycle) {
  AtRisk found;
  for (const Waiting& run : runs) {
    if (run.cycle >= cycle) ++found.waiting;
    if (run.observed && run.cycle == cycle) ++found.events;
  }
  return found;
}

std::set<double> event_cycles(std::span<const Waiting> runs) {
  std::set<double> cycles;
  for (const Waiting& run : runs) {
    if (run.observed) cycles.insert(run.cycle);
  }
  return cycles;
}

/// log2 of the factors at which the order of the two groups changes, ascending.
std::vector<double> factors(std::span<const Waiting> a, std::span<const Waiting> b) {
  std::set<double> found;
  for (const Waiting& x : a) {
    for (const Waiting& y : b) {
      if (x.cycle > 0 && y.cycle > 0) found.insert(std::log2(x.cycle / y.cycle));
    }
  }
  return {found.begin(), found.end()};
}

}  // namespace

std::vector<SurvivalStep> kaplan_meier(std::span<const Waiting> runs) {
  std::vector<SurvivalStep> steps;
  double survival = 1;
  for (const double cycle : event_cycles(runs)) {
    const AtRisk risk = at(runs, cycle);
    survival *= 1 - risk.events / risk.waiting;
    steps.push_back({cycle, survival});
  }
  return steps;
}

std::optional<double> median_wait(std::span<const Waiting> runs) {
  constexpr double rounding = 1e-12;
  const std::vector<SurvivalStep> steps = kaplan_meier(runs);
  const auto reached = std::ranges::find_if(
      steps, [](const SurvivalStep& step) { return step.survival <= 0.5 + rounding; });
  if (reached == steps.end()) return std::nullopt;
  const auto next = std::next(reached);
  const bool half = reached->survival > 0.5 - rounding && next != steps.end();
  return half ? (reached->cycle + next->cycle) / 2 : reached->cycle;
}

double log_rank(std::span<const Waiting> a, std::span<const Waiting> b) {
  std::set<double> cycles = event_cycles(a);
  cycles.merge(event_cycles(b));
  double excess = 0;
  double variance = 0;
  for (const double cycle : cycles) {
    const AtRisk x = at(a, cycle);
    const AtRisk y = at(b, cycle);
    const double waiting = x.waiting + y.waiting;
    const double events = x.events + y.events;
    excess += x.events - events * x.waiting / waiting;
    if (waiting > 1) {
      variance +=
          events * (waiting - events) * x.waiting * y.waiting / (waiting * waiting * (waiting - 1));
    }
  }
  return variance > 0 ? excess / std::sqrt(variance) : 0;
}

std::optional<Estimate> log2_wait_ratio(std::span<const Waiting> a, std::span<const Waiting> b) {
  if (std::min(a.size(), b.size()) < least_runs) return std::nullopt;
  if (event_cycles(a).empty() && event_cycles(b).empty()) return std::nullopt;
  const std::vector<double> edges = factors(a, b);
  if (edges.empty()) return std::nullopt;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const double limit = normal_quantile((1 + confidence_level) / 2);
  std::vector<Waiting> scaled(b.begin(), b.end());
  double negative = edges.front();  // the statistic is negative below this factor
  double positive = edges.back();   // and positive above this one
  Interval kept{infinite, -infinite};
  for (std::size_t k = 0; k <= edges.size(); ++k) {  // between the edges
    const double low = k == 0 ? -infinite : edges[k - 1];
    const double high = k == edges.size() ? infinite : edges[k];
    const double factor = k == 0 ? high - 1 : k == edges.size() ? low + 1 : (low + high) / 2;
    for (std::size_t j = 0; j < b.size(); ++j) scaled[j].cycle = b[j].cycle * std::exp2(factor);
    const double z = log_rank(a, scaled);
    if (std::abs(z) < limit) kept = {std::min(kept.low, low), std::max(kept.high, high)};
    if (z < 0 && k < edges.size()) negative = high;
    if (z > 0 && k > 0) positive = std::min(positive, low);
  }
  const double value = (negative + positive) / 2;
  kept = {std::min(kept.low, value), std::max(kept.high, value)};
  const std::size_t runs = std::min(a.size(), b.size());
  return Estimate{
      .value = value,
      .interval = kept,
      .runs = runs,
      .groups = 2,
      .spread = (kept.high - kept.low) / (2 * limit) * std::sqrt(static_cast<double>(runs))};
}

}  // namespace shearcell
