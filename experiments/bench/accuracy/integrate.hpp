// SPDX-License-Identifier: GPL-3.0-or-later
// The product's integrator and its rivals, behind one call.
//
// A rival is a plain text of its own, kept as evidence and not as a part of the engine. All but
// Runge-Kutta are made of two flows that are known exactly: a drift x' = v, and a kick
// v' = F(x) - b v at fixed x; or the kick with its drag taken implicitly, as the engine does.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "experiments/bench/accuracy/box.hpp"

namespace shearcell::accuracy {

/// A kick and then a drift, in parts of the time step.
struct Substep {
  double kick, drift;
};

/// Which numbers hold the state and which the forces: double and double, float and float, or a
/// state in double with forces in float.
enum class Precision : std::uint8_t { twofold, single, mixed };

struct Method {
  enum class Kind : std::uint8_t { engine, splitting, runge_kutta };
  std::string name;
  Kind kind = Kind::splitting;
  std::vector<Substep> substeps = {};
  double first_drift = 0;  ///< before the substeps
  bool exact_drag = true;  ///< else implicit
  bool staggered = false;  ///< velocities belong to half a time step before the positions
  Precision precision = Precision::twofold;
  int evaluations = 1;  ///< of the forces in one time step
  int order = 2;        ///< where forces are smooth
};

/// The engine's leapfrog with implicit drag, through `Simulation`.
const Method& engine();
/// The engine first, then: its plain copy, the leapfrog with exact drag, PEFRL of Omelyan, Mryglod
/// and Folk, Comput. Phys. Commun. 146, 188 (2002), the classical Runge-Kutta method, and the plain
/// copy in single and in mixed precision.
const std::vector<Method>& methods();

/// Called with the number of steps done and the motion then; velocities as `staggered` says.
using Visit = std::function<void(std::uint64_t step, const Motion& motion)>;

/// Moves the grains `steps` time steps of `dt` [s] on from `start` (positions and velocities of one
/// instant), and visits after every `every` of them. A staggered method gets its velocity of half a
/// step before from a Runge-Kutta step backwards. The engine needs a box with walls.
/// Throws NumericalFailure when the engine's watchdog does.
void integrate(const Box& box, const Method& method, const Motion& start, double dt,
               std::uint64_t steps, std::uint64_t every, const Visit& visit);

/// Total energy [m d^2/s^2] of a visited motion, without drag: a staggered velocity is first kicked
/// on by half a step.
double energy(const Box& box, const Method& method, const Motion& motion, double dt);

}  // namespace shearcell::accuracy
