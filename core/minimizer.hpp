// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanical equilibrium of a packing under gravity and pressure: a local minimum of the enthalpy
//   H = sum of contacts (k/2) overlap^2 + m g sum y + F h
// with respect to the positions of the grains and the distance h between the bottom and top planes.
// The walls are upright. F is the load on the moving wall: P A_w plus carried_weight() (scene.hpp).
#pragma once

#include <cstdint>

#include "core/simulation.hpp"

namespace shearcell {

struct MinimizeSettings {
  /// Limit of |net force| / (P d^2) on grains and of |net force| / (P A_w) on the moving wall.
  double force_tolerance = 1e-4;
  std::uint64_t most_evaluations = 1'000'000;  ///< limit on the number of force evaluations
};

/// Moves the grains and the moving wall to a minimum of the enthalpy by FIRE (Bitzek et al., Phys.
/// Rev. Lett. 97, 170201 (2006), with the changes of Guenole et al., Comput. Mater. Sci. 175,
/// 109584 (2020)). Afterwards all velocities are zero, and the step number is one higher. The
/// result depends only on the positions and the scene, because sums follow the order of permanent
/// ids. Throws NumericalFailure if the tolerance is not reached or a watchdog check fails.
void minimize_enthalpy(Simulation& simulation, const MinimizeSettings& settings = {});

/// Returns the largest net force in a state with upright walls, in the units of force_tolerance.
/// The contacts are found without neighbour lists.
double force_residual(const Cell& cell, const Scene& scene, const State& state);

}  // namespace shearcell
