// SPDX-License-Identifier: GPL-3.0-or-later
// What the hard cases are made of: small cells and packings, and ways to say what came out.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "core/simulation.hpp"
#include "experiments/bench/stability/hard_case.hpp"

namespace shearcell::stability {

/// Table I of the supplement, in units of d, m and s.
Scene table_1();

/// Springs alone: no drag, no gravity, no pressure, and a moving wall too heavy to stir.
Scene only_springs();

/// 2/sqrt(8 k/m) [s], the stability limit of an FCC crystal.
double crystal_limit(const Scene& scene);

/// Smooth walls; the bottom one moves.
Cell smooth_cell(double width, double height, double depth);

State at_rest(const Cell& cell, const std::vector<Eigen::Vector3d>& positions);

struct Packing {
  Cell cell;
  Scene scene;
  State state;
};

/// 60 grains between rough walls, settled under Table I.
const Packing& settled_packing();

/// An FCC crystal of `layers` square layers (odd) of `along` by `along` grains, and of one row less
/// in every other, between smooth walls: in its minimum under a pressure that makes overlaps of
/// about `overlap` [d], without gravity or drag. The grain nearest the middle is left out where
/// `vacancy` is set.
Packing crystal(int layers, double overlap, int along = 5, bool vacancy = false);

/// `count` grains side by side, apart, each touching the bottom and the top wall.
Packing row_between_walls(int count, const Scene& scene);

/// With limits that never stop a run for its time step.
EngineSettings any_time_step();

/// Advances; what stopped it, if anything did.
std::optional<NumericalFailure> advance_or_stop(Simulation& simulation, const Drive& drive,
                                                std::uint64_t steps);

/// "stopped at step 12: the overlap [d] of two grains is 0.5, limit 0.1".
std::string words(const NumericalFailure& failure);

/// Expects to be stopped within `steps` for a quantity whose name holds `quantity`.
Outcome expect_stop(Simulation& simulation, const Drive& drive, std::uint64_t steps,
                    const std::string& quantity);

/// `got` against the right answer, within an absolute tolerance.
Outcome expect_near(const std::string& what, double got, double right, double tolerance);

/// Expects `got` to be at most `most`.
Outcome expect_at_most(const std::string& what, double got, double most);

/// As expected when all are.
Outcome all_of(std::initializer_list<Outcome> parts);
Outcome all_of(const std::vector<Outcome>& parts);

/// Mean kinetic energy of a grain [m d^2/s^2], at the half step.
double kinetic_energy(const State& state);

/// Potential energy of contacts and gravity between upright walls, and the mean of the kinetic
/// energies half a step before and after `state` [m d^2/s^2]; advances by one step.
double total_energy(Simulation& simulation);

/// Its mean over `looks`, seven steps apart. The energy that the leapfrog keeps is not quite this
/// one, which wavers about it.
double mean_energy(Simulation& simulation, int looks);

}  // namespace shearcell::stability
