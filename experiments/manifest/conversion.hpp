// SPDX-License-Identifier: GPL-3.0-or-later
// The one place where SI parameters become the engine's units (grain diameter d, grain mass m,
// second), and quantities that follow from them before anything is simulated.
#pragma once

#include "core/filling.hpp"
#include "core/scene.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell {

Units units(const Parameters& parameters);

/// What acts on the grains under shear; time step = period / steps per cycle.
Scene shear_scene(const Parameters& parameters);

/// What acts on them while they settle: upright walls, a fluid at rest, its own time step.
Scene settle_scene(const Parameters& parameters);

/// Motion of the walls; a pause has the whole number of time steps nearest to pause_s, at least 1.
Drive drive(const Parameters& parameters);

/// Most time steps of one pause.
inline constexpr double kMostPauseSteps = 1e9;

/// pause_s in time steps of the shear, not rounded.
double pause_time_steps(const Parameters& parameters);

/// What acts on them while they stiffen: as while they settle, and no time passes.
Scene stiffen_scene(const Parameters& parameters);

/// Length of the stage after settling: cycles of shear, or stiffnesses.
std::uint64_t target_cycles(const Parameters& parameters);

/// What the cell is built and filled from.
Geometry geometry(const Parameters& parameters);

double shear_time_step_s(const Parameters& parameters);

/// Largest stable time step [s]: 2/omega_max of the leapfrog, with omega_max^2 = 8 k/m. An FCC
/// contact network, the densest there is, has its fastest mode there (twelve springs, the zone
/// boundary X, longitudinal); looser or disordered packings vibrate more slowly.
double stability_limit_s(const Parameters& parameters);

/// Whether it matters where the pressure acts: a moving bottom wall lifts grains that have weight.
bool feels_pressure_at(const Parameters& parameters);

/// Whether the pressure under a moving bottom wall can carry the grains' weight:
/// P d^2 > 1.2 (h/d) m g, with 1.2 grains per d^3. A moving top wall lifts nothing, and under
/// `pressure_at: top` the load includes the weight.
bool pressure_lifts_column(const Parameters& parameters);

/// Stiffening has no time steps that LAMMPS could take.
bool asks_lammps_to_stiffen(const Parameters& parameters);

}  // namespace shearcell
