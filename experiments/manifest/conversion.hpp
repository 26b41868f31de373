// SPDX-License-Identifier: GPL-3.0-or-later
// Converts SI parameters to the engine's units (grain diameter d, grain mass m, second). Also
// computes quantities that follow from the parameters without a simulation.
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

/// The scene of a shear. The time step is period_s / steps_per_cycle.
Scene shear_scene(const Parameters& parameters);

/// The scene of settling: upright walls, a fluid at rest, and the time step settle_time_step_s.
Scene settle_scene(const Parameters& parameters);

/// Motion of the walls. A pause is rounded to a whole number of time steps, at least 1.
Drive drive(const Parameters& parameters);

/// Largest number of time steps in a pause.
inline constexpr double kMostPauseSteps = 1e9;

/// Duration of a pause in time steps of the shear, not rounded.
double pause_time_steps(const Parameters& parameters);

/// Length of the stage that follows settling: number of cycles or, for `stiffen`, of stiffnesses.
std::uint64_t target_cycles(const Parameters& parameters);

Geometry geometry(const Parameters& parameters);

double shear_time_step_s(const Parameters& parameters);

/// Largest stable time step of the leapfrog [s], 2/omega_max. omega_max^2 = 8 k/m belongs to the
/// fastest mode (longitudinal, at the zone boundary X) of an FCC contact network with twelve
/// springs per grain. Looser or disordered packings vibrate more slowly than FCC, the densest one.
double stability_limit_s(const Parameters& parameters);

/// Whether pressure_at has an effect: only if the bottom wall moves and the grains have weight.
bool depends_on_pressure_at(const Parameters& parameters);

/// Whether the pressure under a moving bottom wall can carry the grains' weight: P d^2 > 1.2 (h/d)
/// m g, for 1.2 grains per d^3 and the nominal height h. Also returns true if the top wall moves,
/// because the top wall lifts no grains. Also returns true for `pressure_at: top`, because the load
/// of the moving wall then includes the weight of the grains.
bool pressure_lifts_column(const Parameters& parameters);

struct TimeStep {
  double seconds = 0;
  double over_contact_time = 0;     ///< time step / t_c; a collision takes t_c = pi/sqrt(2 k/m)
  double over_stability_limit = 0;  ///< time step / stability_limit_s()
};

TimeStep time_step(const Parameters& parameters, double seconds);

/// True for steps_per_cycle and settle_time_step_s, which a manifest may set to `auto`.
bool takes_auto(std::string_view key);

/// Sets the parameter `key` so that the time step is about 0.3547 times the stability limit, as in
/// Table I. settle_time_step_s becomes 2 s divided by a whole number. The parameters of Table I
/// give the time step of Table I. The result may be out of range; check it with check_value().
void resolve_auto(std::string_view key, Parameters& parameters);

/// Mean overlap of touching grains at rest [d], to leading order: 0.75 p d/k, where p is the
/// pressure at half the height: P minus half the grains' weight per area if P acts on a moving
/// bottom wall, P plus half this weight if P acts at the top. By the virial, a packing with n
/// grains per volume and z contacts per grain has p = n z k <overlap> d/6, so <overlap>/d = 6/(n
/// d^3 z) p d/k. The factor is 0.77 for n d^3 = 1.22 and z = 6.36 (for N = 2000). Rough side walls
/// bear a part of the pressure, so 0.75 is used, which fits five settled packings within 7 %.
double expected_overlap(const Parameters& parameters);

/// Time [s] after which drag has brought the grains to rest, 18 m/b; infinite without drag. The
/// energy of weakly damped vibrations falls as exp(-b t/m), and must fall by a factor of about
/// exp(18) to reach the default settle_kinetic_tolerance. At the time step of Table I, 300 grains
/// take 18.8 s at m/b = 1 s and 3.0 s at m/b = 0.156 s. Larger time steps heat the grains: at 0.81
/// of the stability limit, the 3.0 s become 6.6 s.
double damping_time_s(const Parameters& parameters);

/// pressing_time() of protocols/settle.hpp [s]: the shortest time in which settling can end. If the
/// drag is large, the time grows in proportion to the drag.
double pressing_time_s(const Parameters& parameters);

/// Whether the cell at its nominal height can be expected to have an interior grain
/// (analysis/packing_fraction.hpp).
bool has_interior(const Parameters& parameters);

/// A warning if the time step is below 0.15 or above 0.7 of the stability limit, otherwise nothing.
/// `key` is the parameter that sets the time step ("steps_per_cycle").
std::optional<std::string> time_step_advice(const TimeStep& step, const std::string& key);

}  // namespace shearcell
