// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/packing.hpp"

#include <cmath>
#include <limits>

#include "core/diagnostics.hpp"
#include "experiments/manifest/conversion.hpp"

namespace shearcell::bench {

Packing placed(const Scene& scene, const std::vector<Eigen::Vector3d>& positions,
               const Eigen::Vector3d& size) {
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

Packing loose_packing(const Parameters& parameters, std::uint64_t seed) {
  Packing packing{parameters, make_cell(geometry(parameters), seed), settle_scene(parameters), {}};
  packing.state = fill_cell(packing.cell, geometry(parameters), seed);
  return packing;
}

Packing pressed_packing(const Parameters& parameters, std::uint64_t seed) {
  Packing packing = loose_packing(parameters, seed);
  packing.state = pressed(packing.cell, packing.state, packing.scene);
  packing.scene = shear_scene(parameters);
  return packing;
}

Simulation simulate(const Packing& packing, const SimulationSettings& settings) {
  return {packing.cell, packing.scene, packing.state, settings};
}

State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive) {
  Simulation simulation = simulate(packing);
  simulation.advance(drive, steps);
  return simulation.state();
}

void settle(Simulation& simulation, const SettleParameters& parameters, const Scene& scene) {
  const Settle protocol(parameters, scene);
  while (!protocol.advance(simulation, std::numeric_limits<std::uint64_t>::max()).finished) {
  }
}

Packing settled_packing(const Parameters& parameters, std::uint64_t seed) {
  Packing packing = loose_packing(parameters, seed);
  Simulation simulation = simulate(packing);
  settle(simulation, {}, packing.scene);
  packing.state = simulation.state();
  packing.state.step = 0;
  return packing;
}

PackingNumbers numbers_of(const Cell& cell, const Scene& scene, double theta, const State& state) {
  const WallPose pose = wall_pose(cell, theta, state.wall_height);
  return {analyse(cell, pose, state.position).measures,
          std::fabs(diagnose(cell, scene, state, pose).wall_imbalance), pose.top - pose.bottom};
}

RunStatistics over(std::span<const PackingNumbers> packings, double PackingNumbers::*number) {
  std::vector<double> values;
  for (const PackingNumbers& packing : packings) values.push_back(packing.*number);
  return over_runs(values);
}

}  // namespace shearcell::bench
