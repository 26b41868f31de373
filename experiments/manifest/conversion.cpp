// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/conversion.hpp"

#include <algorithm>
#include <cmath>

namespace shearcell {
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

Scene stiffen_scene(const Parameters& p) {
  Scene scene = settle_scene(p);
  scene.time_step = 0;
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

bool asks_lammps_to_stiffen(const Parameters& p) {
  return p.engine == EngineKind::lammps && p.protocol == ProtocolKind::stiffen;
}

bool feels_pressure_at(const Parameters& p) {
  return p.gravity_m_per_s2 != 0 && p.moving_wall == MovingWall::bottom;
}

bool pressure_lifts_column(const Parameters& p) {
  if (!feels_pressure_at(p) || p.pressure_at == PressureAt::top) return true;
  constexpr double grains_per_d3 = 1.2;
  const double height = p.height_over_width * cell_width(geometry(p));
  const Scene scene = shear_scene(p);
  return scene.pressure > grains_per_d3 * height * scene.gravity;
}

}  // namespace shearcell
