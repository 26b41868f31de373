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

/// The scene of a shear; its time step is period / steps per cycle.
Scene shear_scene(const Parameters& parameters);

/// The scene of settling: upright walls, a fluid at rest, a time step of its own.
Scene settle_scene(const Parameters& parameters);

/// Motion of the walls; a pause has the whole number of time steps nearest to pause_s, at least 1.
Drive drive(const Parameters& parameters);

/// Largest number of time steps in a pause.
inline constexpr double kMostPauseSteps = 1e9;

/// pause_s in time steps of the shear, not rounded.
double pause_time_steps(const Parameters& parameters);

/// Length of the stage after settling: cycles of shear, or stiffnesses.
std::uint64_t target_cycles(const Parameters& parameters);

/// The geometry of the cell and its filling.
Geometry geometry(const Parameters& parameters);

double shear_time_step_s(const Parameters& parameters);

/// Largest stable time step of the leapfrog [s]: 2/omega_max with omega_max^2 = 8 k/m, the fastest
/// mode of an FCC contact network (twelve springs, longitudinal, at the zone boundary X). FCC is
/// the densest network; looser or disordered packings vibrate more slowly.
double stability_limit_s(const Parameters& parameters);

/// Whether pressure_at has an effect: only if a moving bottom wall lifts grains with weight.
bool depends_on_pressure_at(const Parameters& parameters);

/// Whether the pressure under a moving bottom wall can carry the grains' weight:
/// P d^2 > 1.2 (h/d) m g, with 1.2 grains per d^3. True for a moving top wall, which lifts no
/// grains, and for `pressure_at: top`, where the load includes the weight.
bool pressure_lifts_column(const Parameters& parameters);

/// A time step, and its ratios to two other times.
struct TimeStep {
  double seconds = 0;
  double over_contact_time = 0;     ///< of a collision, pi/sqrt(2 k/m)
  double over_stability_limit = 0;  ///< of stability_limit_s()
};

TimeStep time_step(const Parameters& parameters, double seconds);

/// Whether `settle` may state the parameter for the packing alone: it acts on the grains or on the
/// moving wall, and is not part of the cell, the grains or their units.
bool may_differ_in_settling(std::string_view key);

/// Whether a manifest may set the key to `auto`: steps_per_cycle and settle_time_step_s.
bool takes_auto(std::string_view key);

/// Sets the parameter to the value that keeps the time step at Table I's part of the stability
/// limit, 0.3547: a whole number of steps in a cycle, or in 2 s of settling. The parameters of
/// Table I give Table I's time step. The result may be out of range (check_value).
void resolve_auto(std::string_view key, Parameters& parameters);

/// Mean overlap of touching grains at rest [d], to leading order: 0.75 p d/k. By the virial, a
/// packing with n grains per volume and z contacts per grain has the mean pressure p = n z k
/// <overlap> d/6, so <overlap>/d = 6/(n d^3 z) p d/k. The factor is 0.78 for n d^3 = 1.22 and z =
/// 6.36 (found at N = 2000); because rough side walls bear a part of the pressure, 0.75 fits five
/// settled packings within 7 %. p is the pressure at half the height: P minus half the grains'
/// weight per area if P acts on a moving bottom wall, P plus half of it if P acts at the top.
double expected_overlap(const Parameters& parameters);

/// Time [s] after which drag has brought the grains to rest: 18 m/b. The energy of weakly damped
/// vibrations falls as exp(-b t/m), and must fall by about exp(18) to reach the default
/// settle_kinetic_tolerance. At the time step of Table I, 300 grains take 18.8 s at m/b = 1 s and
/// 3.0 s at 0.156 s; larger steps heat the grains (6.6 s at 0.81 of the stability limit). Infinite
/// without drag.
double damping_time_s(const Parameters& parameters);

/// pressing_time() of protocols/settle.hpp [s], proportional to a large drag. Settling cannot end
/// earlier.
double pressing_time_s(const Parameters& parameters);

/// Whether at least one interior grain (analysis/packing_fraction.hpp) is expected at the nominal
/// height.
bool has_interior(const Parameters& parameters);

/// Advice against a time step below 0.15 or above 0.7 of the stability limit; `key` names it
/// ("steps_per_cycle"). Nothing for other time steps.
std::optional<std::string> time_step_advice(const TimeStep& step, const std::string& key);

}  // namespace shearcell
