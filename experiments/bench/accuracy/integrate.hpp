// SPDX-License-Identifier: GPL-3.0-or-later
// The engine's integrator and two others behind one call, for a few grains in a box at rest.
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
  enum class Kind : std::uint8_t { engine, pefrl, runge_kutta };
  std::string name;
  Kind kind;
  int evaluations;         ///< of the forces in one time step
  int order;               ///< where forces are smooth
  bool staggered = false;  ///< velocities are those of half a time step before the positions
};

/// The engine (leapfrog with implicit drag, through `Simulation`); PEFRL of Omelyan, Mryglod and
/// Folk, Comput. Phys. Commun. 146, 188 (2002), with exact drag; and the classical Runge-Kutta
/// method.
const std::vector<Method>& methods();

/// Called with the number of steps done and the motion then; velocities as `staggered` says.
using Visit = std::function<void(std::uint64_t step, const Motion& motion)>;

/// Advances the grains by `steps` time steps of `dt` [s] from `start` (positions and velocities of
/// one instant) and visits after every `every` of them. A staggered method gets its first velocity
/// from a Runge-Kutta step of -dt/2. Throws NumericalFailure as the engine does.
void integrate(const Box& box, const Method& method, const Motion& start, double dt,
               std::uint64_t steps, std::uint64_t every, const Visit& visit);

}  // namespace shearcell::accuracy
