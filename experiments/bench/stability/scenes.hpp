// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of the hard cases, and the checks of their results.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "experiments/bench/packing.hpp"
#include "experiments/bench/stability/hard_case.hpp"

namespace shearcell::stability {

using bench::Packing;
using V = Eigen::Vector3d;

/// Table I of the supplement, in units of d, m and s.
Scene table_1();

/// Contacts only: no drag, gravity or pressure, and a moving wall too heavy to move.
Scene only_springs();

/// The stability limit of an FCC crystal, 2/sqrt(8 k/m) [s].
double crystal_limit(const Scene& scene);

/// Grains at rest in a smooth cell (width, height, depth) whose bottom wall moves.
Packing placed(const Scene& scene, const std::vector<V>& positions,
               const V& size = V::Constant(40));

/// 60 grains between rough walls, settled under Table I.
const Packing& settled();

/// An FCC crystal of `layers` (odd) square layers of `along` by `along` grains, every other layer
/// with one row less, between smooth walls. It is at its minimum of energy under a pressure that
/// makes overlaps of about `overlap` [d], without gravity or drag. `vacancy` leaves out the grain
/// nearest the middle.
Packing crystal(int layers, double overlap, int along = 5, bool vacancy = false);

/// With the drags of Table I on grains and wall.
Packing in_fluid(Packing packing);

/// `count` grains side by side, apart, each touching the bottom and the top wall.
Packing row_between_walls(int count, const Scene& scene);

Simulation simulate(const Packing& packing, const EngineSettings& settings = {});

/// The state after `steps`. Throws NumericalFailure.
State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive = {});

/// Mean kinetic energy of a grain [m d^2/s^2], at the half step.
double kinetic_energy(const State& state);

/// Energy of contacts, gravity and motion between upright walls [m d^2/s^2], averaged over
/// `samples` 7 steps apart, because the leapfrog keeps a slightly different energy. The kinetic
/// energy is the mean of those half a step before and after. Advances the simulation.
double mean_energy(Simulation& simulation, int samples);

/// Expects the watchdog to stop the run within `steps`, for a quantity with this in its name.
Outcome expect_stop(const Packing& packing, std::uint64_t steps, const std::string& quantity);

/// Expects |got - right| <= tolerance, or got <= most.
Outcome expect_near(const std::string& what, double got, double right, double tolerance);
Outcome expect_at_most(const std::string& what, double got, double most);

/// Expects the run to end as by the sum over all pairs (oracle.hpp), within `tolerance` [d].
Outcome expect_as_all_pairs(const Packing& packing, const State& end, const Drive& drive,
                            double tolerance);

/// Expects no net force over `most` P d^2 on any grain.
Outcome expect_balance(const Packing& packing, const State& state, double most);

/// As expected if all parts are.
Outcome all_of(const std::vector<Outcome>& parts);

}  // namespace shearcell::stability
