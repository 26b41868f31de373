// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of an integrator against closed forms: motions of one or two grains.
#pragma once

#include "experiments/bench/accuracy/integrate.hpp"

namespace shearcell::accuracy {

/// Half the period of two grains on one spring, pi/sqrt(2 k/m) [s]: how long a collision lasts.
double contact_time(const Scene& scene);

/// Root mean squares over the places within a step at which the contact begins.
struct CollisionError {
  double speed = 0;  ///< of separation after it, over the speed of approach
  double time = 0;   ///< of its end, over the contact time
};

/// Two grains meet head on, far from walls: while they touch, the overlap is
///   (u/w) exp(-b t/2m) sin(w t),   w^2 = 2 k/m - (b/2m)^2,
/// with u their speed of approach; before and after, drag slows them down exponentially. Phases are
/// spread evenly over one time step.
CollisionError collision_error(const Scene& scene, const Method& method, double dt, int phases);

/// Root mean square over time, and over the first `periods` of the oscillation, of the error of
/// position, over the amplitude at the start.
///
/// On a wall: one grain lies on the bottom plane under gravity, lifted by half of its overlap g/k,
/// and so never leaves it. In a cage: one grain between four planes 1 - 0.02 d apart, which all
/// touch it all the time, let go from 0.005 d off its middle in x and y. Both are damped harmonic
/// motions,
///   x - x_0 = a exp(-b t/2m) (cos w t + b/(2 m w) sin w t),   w^2 = n k/m - (b/2m)^2,
/// with n = 1 on the wall and n = 2 in the cage.
double wall_error(const Scene& scene, const Method& method, double dt, double periods);
double cage_error(const Scene& scene, const Method& method, double dt, double periods);

}  // namespace shearcell::accuracy
