// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/cost.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/minimizer.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"

namespace shearcell {
namespace {

// Particle-steps/s assumed until the store has measured them: rough cells on one core of an EPYC
// (Zen 4), from `bench speed`; LAMMPS 29 Sep 2021 with one process (SCALING.md).
struct MeasuredRate {
  double grains, rate;
};
constexpr MeasuredRate kOurRates[] = {{5200, 74e6}, {1e5, 57e6}, {1e6, 53e6}};
constexpr MeasuredRate kLammpsRates[] = {{5200, 6.6e6}, {1e5, 3.0e6}};

// A power law in N between two measured sizes, constant beyond the outermost ones.
double assumed_rate(std::span<const MeasuredRate> rates, double grains) {
  if (grains <= rates.front().grains) return rates.front().rate;
  for (std::size_t i = 1; i < rates.size(); ++i) {
    const MeasuredRate &a = rates[i - 1], &b = rates[i];
    if (grains > b.grains) continue;
    const double part = std::log(grains / a.grains) / std::log(b.grains / a.grains);
    return a.rate * std::pow(b.rate / a.rate, part);
  }
  return rates.back().rate;
}

// Size of a checkpoint file, measured: its grains, its wall grains, and the layout around them.
constexpr double kBytesPerGrain = 121;
constexpr double kBytesPerWallGrain = 98;
constexpr double kBytesPerFile = 18e3;

}  // namespace

double run_bytes(const Geometry& shape) {
  return kRunBytesPerGrain * (static_cast<double>(shape.grains) + wall_grain_count(shape));
}

double checkpoint_bytes(const Geometry& shape) {
  return kBytesPerFile + kBytesPerGrain * static_cast<double>(shape.grains) +
         kBytesPerWallGrain * wall_grain_count(shape);
}

double settling_time_s(const Parameters& p) {
  const double height = p.height_over_width * cell_width(geometry(p));
  const double time = 0.6 + 0.00175 * height * height;
  return std::min(std::max(time, damping_time_s(p)), p.settle_time_limit_s);
}

double minimization_evaluations(double grains) {
  return 18e3 * std::pow(grains / 2000, 0.7);
}

Rates::Rates(const std::vector<Stage>& runs) {
  for (const Stage& run : runs) {
    Sum& sum = sums_[engine_of(run.resolved)];
    sum.steps += run.particle_steps;
    sum.seconds += run.wall_seconds;
  }
}

Rate Rates::of(const Stage& stage) const {
  const EngineKind engine = engine_of(stage.resolved);
  const auto grains = static_cast<double>(stage.grains);
  const auto sum = sums_.find(engine);
  if (sum != sums_.end() && sum->second.seconds >= 1) {
    return {sum->second.steps / sum->second.seconds, true};
  }
  if (engine == EngineKind::lammps) return {assumed_rate(kLammpsRates, grains), false};
  return {assumed_rate(kOurRates, grains), false};
}

void Work::add(const Stage& stage, double steps_left, const Rates& rates) {
  const Rate rate = rates.of(stage);
  const double own_seconds = steps_left / rate.particle_steps_per_second;
  ++stages;
  particle_steps += steps_left;
  core_seconds += own_seconds;
  measured = measured && rate.measured;
  longest_seconds = std::max(longest_seconds, chain[stage.id] = chain[stage.parent] + own_seconds);
}

double Work::seconds(std::size_t at_a_time) const {
  return std::max(longest_seconds, core_seconds / static_cast<double>(at_a_time));
}

std::set<std::string> waiting_for_failed(const std::vector<Stage>& runs) {
  std::set<std::string> failed, waiting;
  for (const Stage& run : runs) {
    if (run.state == StageState::failed) failed.insert(run.id);
  }
  for (const Stage& run : runs) {
    if (!has_ended(run.state) && failed.contains(run.parent)) waiting.insert(run.id);
  }
  return waiting;
}

}  // namespace shearcell
