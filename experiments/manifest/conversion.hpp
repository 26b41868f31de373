// SPDX-License-Identifier: GPL-3.0-or-later
// The one place where SI parameters become the engine's units (grain diameter d, grain mass m,
// second), and quantities that follow from them before anything is simulated.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

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

/// A time step beside the two times that it is measured by.
struct TimeStep {
  double seconds = 0;
  double over_contact_time = 0;     ///< of a collision, pi/sqrt(2 k/m)
  double over_stability_limit = 0;  ///< of stability_limit_s()
};

TimeStep shear_time_step(const Parameters& parameters);
TimeStep settle_time_step(const Parameters& parameters);

/// Whether a manifest may set the key to `auto`: steps_per_cycle and settle_time_step_s.
bool takes_auto(std::string_view key);

/// Sets the parameter to the value that keeps the time step at Table I's part of the stability
/// limit, 0.3547: a whole number of steps in a cycle, or in 2 s of settling. The parameters of
/// Table I give Table I's time step. The result may be out of range (check_value).
void resolve_auto(std::string_view key, Parameters& parameters);

/// Mean overlap of touching grains at rest [d], to leading order in it: 0.75 p d/k. By the virial
/// the mean pressure of a packing with n grains per volume and z contacts of each is p = n z k
/// <overlap> d/6, so <overlap>/d = 6/(n d^3 z) p d/k, which is 0.78 for n d^3 = 1.22 and z = 6.36
/// (found at N = 2000); 0.75 fits five settled packings within 7 % (core/ACCURACY.md), as
/// rough side walls bear a part. The pressure p is that at half the height: P less half the grains'
/// weight per area where P acts on a moving bottom wall, and P plus as much where it acts at the
/// top.
double expected_overlap(const Parameters& parameters);

/// Below this part of the stability limit a smaller time step changes nothing that seeds would
/// show, and above the other the fastest vibrations are off by more than 10 % (core/ACCURACY.md).
inline constexpr double kNeedlesslySmallStep = 0.15;
inline constexpr double kTooLargeStep = 0.7;

/// What is unwise about a time step named `key` ("steps_per_cycle"), with the remedy, or nothing.
std::optional<std::string> time_step_advice(const TimeStep& step, const std::string& key);

}  // namespace shearcell
