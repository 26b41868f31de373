// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of the forces on the grains and of the motion of the walls. The units are the grain
// diameter d, the grain mass m and the second.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/cell.hpp"
#include "core/named.hpp"

namespace shearcell {

/// Motion of the fluid, whose velocity enters the Stokes drag -b (v - v_fluid). Supplement B.3.
enum class Fluid : std::uint8_t { still, cell };
template <>
inline constexpr auto kNames<Fluid> = names_in_order<Fluid>("still", "cell");

/// Ratio of du_x/dy of the fluid to du_x/dy of the cell. The fluid is at rest at the top wall.
constexpr double fluid_share(Fluid fluid) {
  switch (fluid) {
    case Fluid::still:
      return 0;
    case Fluid::cell:
      return 1;
  }
  return 0;
}

/// The wall on which the pressure is P. `moving_wall`: the load on the moving wall is P A_w. If the
/// bottom wall moves, part of this load balances the weight of the grains, so the pressure on the
/// top wall is below P. `top`: the load on a moving bottom wall is P A_w plus the weight of the
/// grains. The pressure on the top wall is then P, or less if rough side walls carry load.
enum class PressureAt : std::uint8_t { moving_wall, top };
template <>
inline constexpr auto kNames<PressureAt> = names_in_order<PressureAt>("moving_wall", "top");

struct Scene {
  double stiffness = 0;  ///< k/m [1/s^2]
  double drag_rate = 0;  ///< b/m [1/s]
  double gravity = 0;    ///< g/d [1/s^2]; 0 switches gravity off
  double pressure = 0;   ///< P d/m [1/s^2]
  PressureAt pressure_at = PressureAt::top;
  double wall_mass = 10;    ///< M_w per d^2 of wall [m]
  double wall_drag = 1000;  ///< B_w per d^2 of wall [m/s]
  double time_step = 0;     ///< [s]
  Fluid fluid = Fluid::still;
};

/// Weight that is added to the load P A_w on the moving wall [m d/s^2]. It is the weight of all
/// grains for a moving bottom wall with PressureAt::top, and 0 otherwise.
inline double carried_weight(const Scene& scene, const Cell& cell, std::size_t grains) {
  const bool carries = scene.pressure_at == PressureAt::top && cell.moving == MovingWall::bottom;
  return carries ? scene.gravity * static_cast<double>(grains) : 0.0;
}

/// Motion of the moving wall during a pause: held at its height, or free to move under its load.
enum class PauseWalls : std::uint8_t { held, moving };
template <>
inline constexpr auto kNames<PauseWalls> = names_in_order<PauseWalls>("held", "moving");

/// The tilt theta(t) = A sin(omega t). A cycle is a whole number of steps, so it ends at exactly
/// theta = 0. After each cycle the side walls may stay upright for `pause_steps` steps
/// (periodically paused shear, B.5).
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
