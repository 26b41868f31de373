// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/numerics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/manifest/conversion.hpp"

namespace shearcell {
namespace {

TimeStep time_step(const Parameters& p, double seconds) {
  const double contact_time = std::numbers::pi / std::sqrt(2 * p.stiffness_N_per_m / p.mass_kg);
  return {seconds, seconds / contact_time, seconds / stability_limit_s(p)};
}

/// Whole steps in `duration` at Table I's part of the stability limit; at least 1.
double auto_steps(double duration, const Parameters& p) {
  const Parameters table1;
  const double part = shear_time_step_s(table1) / stability_limit_s(table1);
  const double steps = std::nearbyint(duration / (part * stability_limit_s(p)));
  constexpr double most = 1e15;  // exact, and far beyond what a manifest may state
  return steps >= 1 ? std::min(steps, most) : 1;
}

}  // namespace

bool takes_auto(std::string_view key) {
  return key == "steps_per_cycle" || key == "settle_time_step_s";
}

void resolve_auto(std::string_view key, Parameters& p) {
  if (key == "steps_per_cycle") {
    p.steps_per_cycle = static_cast<std::uint64_t>(auto_steps(p.period_s, p));
  } else {
    const double duration = Parameters{}.period_s;
    p.settle_time_step_s = duration / auto_steps(duration, p);
  }
}

TimeStep shear_time_step(const Parameters& parameters) {
  return time_step(parameters, shear_time_step_s(parameters));
}

TimeStep settle_time_step(const Parameters& parameters) {
  return time_step(parameters, parameters.settle_time_step_s);
}

double expected_overlap(const Parameters& p) {
  constexpr double grains_per_d3 = 1.2, of_pressure = 0.75;
  const Scene scene = shear_scene(p);
  const double height = p.height_over_width * cell_width(geometry(p));
  const double half_weight = grains_per_d3 * height * scene.gravity / 2;
  const bool hangs =
      p.moving_wall == MovingWall::bottom && p.pressure_at == PressureAt::moving_wall;
  const double sign = hangs ? -1 : 1;
  return of_pressure * std::max(scene.pressure + sign * half_weight, 0.0) / scene.stiffness;
}

std::optional<std::string> time_step_advice(const TimeStep& step, const std::string& key) {
  const bool large = step.over_stability_limit > kTooLargeStep;
  if (!large && step.over_stability_limit >= kNeedlesslySmallStep) return std::nullopt;
  const double wanted = large ? kTooLargeStep : kNeedlesslySmallStep;
  return fmt::format(
      "{}: the time step of {:.3g} s is {:.3g} of the stability limit, {} {:g}: {}", key,
      step.seconds, step.over_stability_limit, large ? "above" : "below", wanted,
      large ? "the fastest vibrations are wrong by more than 10 %"
            : "it costs time and changes no measure by as much as another seed does");
}

}  // namespace shearcell
