// SPDX-License-Identifier: GPL-3.0-or-later
// The engine's integrator and two others behind one call, for a few grains in a box at rest, and
// their errors against motions that are known in closed form.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/scene.hpp"

namespace shearcell::accuracy {

/// Smooth planes at 0 and at the size in x and y, touched at distance 1/2; periodic in z.
struct Box {
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< [d]
  double stiffness = 0;                            ///< k/m [1/s^2]
  double drag_rate = 0;                            ///< b/m [1/s]
  double gravity = 0;                              ///< g/d [1/s^2], along -y
};

/// Column i is grain i.
struct Motion {
  Eigen::Matrix3Xd position;  ///< [d]
  Eigen::Matrix3Xd velocity;  ///< [d/s]
};

struct Method {
  std::string name;
  int evaluations;  ///< of the forces in one time step
  int order;        ///< where forces are smooth
  /// One time step; null for the engine, whose velocities are those of half a time step before.
  void (*step)(const Box& box, double dt, Motion& motion);
};

/// The engine (leapfrog with implicit drag, through `Simulation`); PEFRL of Omelyan, Mryglod and
/// Folk, Comput. Phys. Commun. 146, 188 (2002), with exact drag; and the classical Runge-Kutta
/// method.
const std::vector<Method>& methods();

/// Called with the number of steps done and the motion then.
using Visit = std::function<void(std::uint64_t step, const Motion& motion)>;

/// The motion `steps` time steps of `dt` [s] after `start` (positions and velocities of one
/// instant); visits each step. The engine gets its first velocity from a Runge-Kutta step of -dt/2.
/// Throws NumericalFailure as the engine does.
Motion integrate(const Box& box, const Method& method, const Motion& start, double dt,
                 std::uint64_t steps, const Visit& visit = {});

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

/// With `quick` they are compared less thoroughly: less often, in shorter motions.
std::vector<ClosedForm> closed_forms(const Scene& scene, bool quick);

/// Order of convergence: the slope of log(error) against log(step), over time steps from `largest`
/// down by factors of the fourth root of 2.
double fitted_order(const ClosedForm& form, const Method& method, double largest);

}  // namespace shearcell::accuracy
