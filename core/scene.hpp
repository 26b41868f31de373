// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on the grains and motion of the walls, in units of grain diameter d, grain mass m and
// second.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/cell.hpp"
#include "core/named.hpp"

namespace shearcell {

/// The fluid's velocity in the Stokes drag -b (v - v_fluid). Supplement B.3.
enum class Fluid : std::uint8_t { still, cell };
template <>
inline constexpr auto kNames<Fluid> = names_in_order<Fluid>("still", "cell");

/// Shear rate du_x/dy of the fluid over that of the cell. The fluid is at rest at the top wall.
constexpr double fluid_share(Fluid fluid) {
  switch (fluid) {
    case Fluid::still:
      return 0;
    case Fluid::cell:
      return 1;
  }
  return 0;
}

/// The wall on which the pressure is P. `moving_wall`: the load on the moving wall is P A_w; since
/// a moving bottom wall also carries the grains, the top wall then bears less than P. `top`: a
/// moving bottom wall is loaded with P A_w and the weight of the grains, so the top wall bears P,
/// except for what rough side walls bear.
enum class PressureAt : std::uint8_t { moving_wall, top };
template <>
inline constexpr auto kNames<PressureAt> = names_in_order<PressureAt>("moving_wall", "top");

struct Scene {
  double stiffness = 0;  ///< k/m [1/s^2]
  double drag_rate = 0;  ///< b/m [1/s]
  double gravity = 0;    ///< g/d [1/s^2]; 0 is off
  double pressure = 0;   ///< P d/m [1/s^2]: force on one d^2 of wall
  PressureAt pressure_at = PressureAt::top;
  double wall_mass = 10;    ///< M_w per d^2 of wall [m]
  double wall_drag = 1000;  ///< B_w per d^2 of wall [m/s]
  double time_step = 0;     ///< [s]
  Fluid fluid = Fluid::still;
};

/// The part of the grains' weight that adds to the load P A_w on the moving wall [m d/s^2]: all of
/// it for a moving bottom wall under PressureAt::top, otherwise 0.
inline double carried_weight(const Scene& scene, const Cell& cell, std::size_t grains) {
  const bool carries = scene.pressure_at == PressureAt::top && cell.moving == MovingWall::bottom;
  return carries ? scene.gravity * static_cast<double>(grains) : 0.0;
}

/// The moving wall during a pause: held at its height, or free to move under its load.
enum class PauseWalls : std::uint8_t { held, moving };
template <>
inline constexpr auto kNames<PauseWalls> = names_in_order<PauseWalls>("held", "moving");

/// The tilt theta(t) = A sin(omega t), by whole steps so that a cycle ends at theta = 0 exactly.
/// After each cycle the side walls may rest upright for `pause_steps` (periodically paused shear,
/// B.5).
struct Drive {
  double amplitude = 0;  ///< A [rad]; 0 keeps the walls upright
  std::uint64_t steps_per_cycle = 1;
  std::uint64_t pause_steps = 0;
  PauseWalls pause_walls = PauseWalls::held;
};

/// SI values of d and m. The unit of time is the second.
struct Units {
  double diameter_m = 3e-3;
  double mass_kg = 2e-5;
};

}  // namespace shearcell
