// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/packing_fraction.hpp"
#include "protocols/settle.hpp"

namespace shearcell {
namespace {

/// Number (>= 1) of time steps in `duration`. As in Table I, the time step is 0.3547 of the
/// stability limit.
double auto_steps(double duration, const Parameters& p) {
  const Parameters table1;
  const double part = shear_time_step_s(table1) / stability_limit_s(table1);
  const double steps = std::nearbyint(duration / (part * stability_limit_s(p)));
  constexpr double most = 1e15;  // exact as a double, and above any allowed number
  return steps >= 1 ? std::min(steps, most) : 1;
}

// Weight of the grains per area [m/(d s^2)], for the nominal cell height and 1.2 grains per d^3.
double column_weight(const Parameters& p) {
  constexpr double grains_per_d3 = 1.2;
  const double height = p.height_over_width * cell_width(geometry(p));
  return grains_per_d3 * height * shear_scene(p).gravity;
}

}  // namespace

Units units(const Parameters& p) {
  return {.diameter_m = p.diameter_m, .mass_kg = p.mass_kg};
}

Scene shear_scene(const Parameters& p) {
  return {.stiffness = p.stiffness_N_per_m / p.mass_kg,
          .drag_rate = p.drag_kg_per_s / p.mass_kg,
          .gravity = p.gravity_m_per_s2 / p.diameter_m,
          .pressure = p.pressure_Pa * p.diameter_m / p.mass_kg,
          .pressure_at = p.pressure_at,
          .wall_mass = p.wall_mass_grains_per_d2,
          .wall_drag = p.wall_drag_grains_per_d2_s,
          .time_step = shear_time_step_s(p),
          .fluid = p.fluid};
}

Scene settle_scene(const Parameters& p) {
  Scene scene = shear_scene(p);
  scene.time_step = p.settle_time_step_s;
  scene.fluid = Fluid::still;
  return scene;
}

std::uint64_t target_cycles(const Parameters& p) {
  if (p.protocol != ProtocolKind::stiffen) return p.cycles;
  return 1 + p.stiffness_decades * p.stiffness_steps_per_decade;
}

Drive drive(const Parameters& p) {
  Drive drive{.amplitude = p.amplitude_rad, .steps_per_cycle = p.steps_per_cycle, .pause_steps = 0};
  if (p.protocol == ProtocolKind::paused) {
    const double steps = std::clamp(std::nearbyint(pause_time_steps(p)), 1.0, kMostPauseSteps);
    drive.pause_steps = static_cast<std::uint64_t>(steps);
    drive.pause_walls = p.pause_walls;
  }
  return drive;
}

Geometry geometry(const Parameters& p) {
  return {.grains = static_cast<std::size_t>(p.grains),
          .height_over_width = p.height_over_width,
          .nominal_packing_fraction = p.nominal_packing_fraction,
          .fill_packing_fraction = p.fill_packing_fraction,
          .walls = p.walls,
          .wall_grain_area_fraction = p.wall_grain_area_fraction,
          .wall_grain_recess = p.wall_grain_recess_diameters,
          .wall_grain_draw = static_cast<std::uint32_t>(p.wall_grain_draw),
          .moving = p.moving_wall};
}

double shear_time_step_s(const Parameters& p) {
  return p.period_s / static_cast<double>(p.steps_per_cycle);
}

double pause_time_steps(const Parameters& p) {
  return p.pause_s / shear_time_step_s(p);
}

double stability_limit_s(const Parameters& p) {
  return 2 / std::sqrt(8 * p.stiffness_N_per_m / p.mass_kg);
}

bool depends_on_pressure_at(const Parameters& p) {
  return p.gravity_m_per_s2 != 0 && p.moving_wall == MovingWall::bottom;
}

bool pressure_lifts_column(const Parameters& p) {
  if (!depends_on_pressure_at(p) || p.pressure_at == PressureAt::top) return true;
  return shear_scene(p).pressure > column_weight(p);
}

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

TimeStep time_step(const Parameters& p, double seconds) {
  const double contact_time = std::numbers::pi / std::sqrt(2 * p.stiffness_N_per_m / p.mass_kg);
  return {seconds, seconds / contact_time, seconds / stability_limit_s(p)};
}

double expected_overlap(const Parameters& p) {
  constexpr double of_pressure = 0.75;
  const Scene scene = shear_scene(p);
  const bool hangs =
      p.moving_wall == MovingWall::bottom && p.pressure_at == PressureAt::moving_wall;
  const double half_weight = column_weight(p) / 2 * (hangs ? -1 : 1);
  return of_pressure * std::max(scene.pressure + half_weight, 0.0) / scene.stiffness;
}

double damping_time_s(const Parameters& p) {
  return 18 * p.mass_kg / p.drag_kg_per_s;
}

double pressing_time_s(const Parameters& p) {
  const Geometry shape = geometry(p);
  const double width = cell_width(shape);
  return pressing_time(settle_scene(p), fill_height(shape),
                       static_cast<double>(p.grains) / (width * width));
}

bool has_interior(const Parameters& p) {
  const double margin =
      interior_distance + (p.walls == WallTexture::rough ? rough_wall_surface : 0.0);
  const double width = cell_width(geometry(p)), height = p.height_over_width * width;
  const double per_d3 = p.nominal_packing_fraction * 6 / std::numbers::pi;
  const double across = std::max(width - 2 * margin, 0.0), up = std::max(height - 2 * margin, 0.0);
  return per_d3 * across * up * width >= 1;
}

std::optional<std::string> time_step_advice(const TimeStep& step, const std::string& key) {
  // Fractions of the stability limit; core/ACCURACY.md gives the reasons.
  constexpr double too_small = 0.15, too_large = 0.7;
  const bool large = step.over_stability_limit > too_large;
  if (!large && step.over_stability_limit >= too_small) return std::nullopt;
  return fmt::format("{}: the time step {:.3g} s is {:.3g} times the stability limit ({} {:g}). {}",
                     key, step.seconds, step.over_stability_limit, large ? "above" : "below",
                     large ? too_large : too_small,
                     large ? "The frequency of the fastest vibrations is wrong by more than 10 %"
                           : "A larger step saves time and changes measures by less than the "
                             "scatter between seeds");
}

}  // namespace shearcell
