// SPDX-License-Identifier: GPL-3.0-or-later
// Packings that several tests start from, and the numbers by which packings are compared.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "analysis/analyse.hpp"
#include "core/diagnostics.hpp"
#include "experiments/bench/packing.hpp"
#include "experiments/manifest/conversion.hpp"
#include "protocols/settle.hpp"

namespace shearcell::test {

using bench::Packing;

/// The cell of these parameters with its loose grains and the scene of settling.
inline Packing loose_packing(const Parameters& parameters, std::uint64_t seed) {
  const Geometry shape = geometry(parameters);
  Packing packing{parameters, make_cell(shape, seed), settle_scene(parameters), {}};
  packing.state = fill_cell(packing.cell, shape, seed);
  return packing;
}

/// Grains at rest in a smooth cell (width, height, depth) whose bottom wall moves.
inline Packing placed(const Scene& scene, const std::vector<Eigen::Vector3d>& positions,
                      const Eigen::Vector3d& size = Eigen::Vector3d::Constant(40)) {
  Packing made;
  made.scene = scene;
  made.cell.width = size.x();
  made.cell.top = size.y();
  made.cell.depth = size.z();
  const auto n = static_cast<Eigen::Index>(positions.size());
  made.state.position.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    made.state.position.col(i) = positions[static_cast<std::size_t>(i)];
  }
  made.state.velocity = Eigen::Matrix3Xd::Zero(3, n);
  made.state.wall_height = made.cell.bottom;
  return made;
}

inline void settle(Simulation& simulation, const SettleParameters& parameters, const Scene& scene) {
  const Settle protocol(parameters, scene);
  while (!protocol.advance(simulation, std::numeric_limits<std::uint64_t>::max()).finished) {
  }
}

/// A settled packing at step 0, with the scene of settling. Throws NumericalFailure if the grains
/// do not settle.
inline Packing settled_packing(const Parameters& parameters, std::uint64_t seed) {
  Packing packing = loose_packing(parameters, seed);
  Simulation simulation = bench::simulate(packing);
  settle(simulation, {}, packing.scene);
  packing.state = simulation.state();
  packing.state.step = 0;
  return packing;
}

struct PackingNumbers : PackingMeasures {
  double imbalance = 0;  ///< |load - contact force| / (P A_w) of the moving wall
  double height = 0;     ///< of the cell [d]
};

/// The numbers of a state between upright walls. Throws AnalysisError as analyse() does.
inline PackingNumbers numbers_of(const Cell& cell, const Scene& scene, const State& state) {
  Checkpoint checkpoint;
  checkpoint.cell = cell;
  checkpoint.state = state;
  const WallPose pose = pose_of(checkpoint);
  return {analyse(checkpoint).measures,
          std::fabs(diagnose(cell, scene, state, pose).wall_imbalance), pose.top - pose.bottom};
}

/// Largest distance between the positions of a grain in two states [d].
inline double farthest(const State& a, const State& b) {
  return (a.position - b.position).colwise().norm().maxCoeff();
}

}  // namespace shearcell::test
