// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanical equilibrium of a packing under gravity and pressure: a local minimum of the enthalpy
//   H = sum of contacts (k/2) overlap^2 + m g sum y + F h
// over the positions of the grains and the height h between bottom and top, walls upright. F is the
// load on the moving wall: P A_w, plus carried_weight() (scene.hpp).
#pragma once

#include <cstdint>

#include "core/simulation.hpp"

namespace shearcell {

struct MinimizeSettings {
  /// Largest net force on any grain over P d^2, and |net force on the moving wall| over P A_w.
  double force_tolerance = 1e-4;
  std::uint64_t most_evaluations = 1'000'000;  ///< of the forces, before it counts as a failure
};

/// Moves the simulation to a minimum by FIRE (Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006),
/// with the changes of Guenole et al., Comput. Mater. Sci. 175, 109584 (2020)). Velocities become
/// zero and the step is raised by one. The result depends on the positions and the scene alone;
/// global sums run in the order of permanent ids. Throws NumericalFailure when the tolerance is not
/// reached or a watchdog check fails.
void minimize_enthalpy(Simulation& simulation, const MinimizeSettings& settings = {});

/// The quantity that force_tolerance limits, for a state between upright walls, with forces summed
/// contact by contact.
double force_residual(const Cell& cell, const Scene& scene, const State& state);

}  // namespace shearcell
