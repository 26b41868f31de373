// SPDX-License-Identifier: GPL-3.0-or-later
// The packings that the benchmarks start from, and the numbers by which packings are compared.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/measures.hpp"
#include "analysis/statistics.hpp"
#include "core/simulation.hpp"
#include "experiments/manifest/parameters.hpp"
#include "protocols/settle.hpp"

namespace shearcell::bench {

/// Grains in a cell, and the scene that acts on them.
struct Packing {
  Parameters parameters;  ///< defaults if the cell is not made from parameters
  Cell cell;
  Scene scene;
  State state;
};

/// Grains at rest in a smooth cell (width, height, depth) whose bottom wall moves.
Packing placed(const Scene& scene, const std::vector<Eigen::Vector3d>& positions,
               const Eigen::Vector3d& size = Eigen::Vector3d::Constant(40));

/// The cell of these parameters with its loose grains and the scene of settling. Throws
/// GeometryError.
Packing loose_packing(const Parameters& parameters, std::uint64_t seed);

/// A loose packing pressed together without gravity: dense but not at rest, at step 0, with the
/// scene of shearing.
Packing pressed_packing(const Parameters& parameters, std::uint64_t seed);

/// A settled packing at step 0, with the scene of settling. Throws NumericalFailure if the grains
/// do not settle.
Packing settled_packing(const Parameters& parameters, std::uint64_t seed);

Simulation simulate(const Packing& packing, const SimulationSettings& settings = {});

/// The state after `steps`. Throws NumericalFailure.
State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive = {});

void settle(Simulation& simulation, const SettleParameters& parameters, const Scene& scene);

struct PackingNumbers : Measures {
  double imbalance = 0;  ///< |load - contact force| / (P A_w) of the moving wall
  double height = 0;     ///< of the cell [d]
};

/// The numbers of a state at tilt `theta` [rad]. Throws AnalysisError as analyse() does.
PackingNumbers numbers_of(const Cell& cell, const Scene& scene, double theta, const State& state);

/// Statistics of one number over several packings.
RunStatistics over(std::span<const PackingNumbers> packings, double PackingNumbers::*number);

}  // namespace shearcell::bench
