// SPDX-License-Identifier: GPL-3.0-or-later
// The engine's integrator and two others with one interface, for a few grains between smooth walls
// at rest, and their errors against motions known in closed form.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tests/support/packing.hpp"

namespace shearcell::test {

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

/// Two grains on one spring: how long a collision lasts [s], pi/sqrt(2 k/m - (b/2m)^2).
double contact_time(const Scene& scene);

/// Errors of a head-on collision with the drag of `scene`, over collisions that begin and end at
/// any part of a time step: `samples` of them, with contact times that differ by up to a step.
struct Collision {
  double speed_error = 0;    ///< root mean square error of the speed after it, over that before
  double energy_change = 0;  ///< mean of the energy after it, over the right one, less 1
};
Collision collide(const Scene& scene, const Method& method, double dt, int samples);

/// Angular frequency [rad/s] of the longitudinal wave with n periods in a row of touching grains
/// without drag. The exact one is 2 sqrt(k/m) sin(pi n / grains).
double row_frequency(const Scene& scene, const Method& method, double dt, int grains, int n);

/// One error of a method at a time step [s]; 0 for the exact motion.
struct ClosedForm {
  std::string name, title;
  bool smooth;  ///< no contact opens or closes: the order is that of the method
  std::function<double(const Method& method, double dt)> error;
};

/// Collisions are averaged over so many.
std::vector<ClosedForm> closed_forms(const Scene& scene, int samples);

/// Order of convergence: the slope of log(error) against log(step), by least squares.
double order_of(std::span<const double> steps, std::span<const double> errors);

}  // namespace shearcell::test
