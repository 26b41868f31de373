// SPDX-License-Identifier: GPL-3.0-or-later
// The engine's integrator and two others with one interface, for a few grains between smooth walls
// at rest, and their errors against motions known in closed form.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "experiments/bench/packing.hpp"

namespace shearcell::accuracy {

using bench::Packing;

/// Contacts alone: no drag, gravity or pressure, and walls that stay at rest.
Scene contacts_only(double stiffness);

struct Method {
  std::string name;
  int evaluations;  ///< of the forces in one time step
  /// One time step; null for the engine, whose velocities are those of half a time step before.
  void (*step)(const Packing& box, double dt, State& state);
};

/// The engine (leapfrog with implicit drag, through `Simulation`); PEFRL of Omelyan, Mryglod and
/// Folk, Comput. Phys. Commun. 146, 188 (2002), with exact drag; and the classical Runge-Kutta
/// method.
const std::vector<Method>& methods();

/// Called with the number of steps done and the state after them.
using Visit = std::function<void(std::uint64_t step, const State& state)>;

/// The state after `steps` time steps of `dt` [s] from that of `box`, whose positions and
/// velocities are of one instant; visits each step. The engine gets its first velocity from a
/// Runge-Kutta step of -dt/2. Throws NumericalFailure as the engine does.
State integrate(const Packing& box, const Method& method, double dt, std::uint64_t steps,
                const Visit& visit = {});

/// Half the period of two grains on one spring, pi/sqrt(2 k/m) [s]: how long a collision lasts.
double contact_time(const Scene& scene);

/// One error of a method at a time step [s]; 0 for the exact motion.
struct ClosedForm {
  std::string name;   ///< of its files
  std::string title;  ///< what the error is of
  std::string error;  ///< column and axis
  std::function<double(const Method& method, double dt)> measure;
  /// Single errors scatter, because a contact ends within a step: fit the order over many steps.
  bool irregular = false;
};

/// With `quick`: fewer starts and shorter motions.
std::vector<ClosedForm> closed_forms(const Scene& scene, bool quick);

/// Order of convergence: the slope of log(error) against log(step), over time steps from `largest`
/// down by factors of the fourth root of 2.
double fitted_order(const ClosedForm& form, const Method& method, double largest);

}  // namespace shearcell::accuracy
