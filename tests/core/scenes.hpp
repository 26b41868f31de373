// SPDX-License-Identifier: GPL-3.0-or-later
// Small cells and states that several tests start from.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/filling.hpp"
#include "core/simulation.hpp"

namespace shearcell::test {

/// Table I in units of d, m and s.
inline Scene table_1() {
  Scene scene;
  scene.stiffness = 654 / 2e-5;
  scene.drag_rate = 64;
  scene.gravity = 3270;
  scene.pressure = 954 * 3e-3 / 2e-5;
  scene.pressure_at = PressureAt::moving_wall;
  scene.time_step = 2.0 / 45600;
  return scene;
}

/// Nothing but springs.
inline Scene only_contacts() {
  Scene scene = table_1();
  scene.drag_rate = scene.gravity = scene.pressure = 0;
  return scene;
}

/// A smooth cell so large that its walls are out of reach of what happens near its middle, with a
/// moving wall too heavy to stir.
inline Cell open_cell(double size = 40) {
  Cell cell;
  cell.width = cell.depth = cell.top = size;
  return cell;
}

inline State at_rest(const std::vector<Eigen::Vector3d>& positions, const Cell& cell) {
  State state;
  const auto n = static_cast<Eigen::Index>(positions.size());
  state.position.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i)
    state.position.col(i) = positions[static_cast<std::size_t>(i)];
  state.velocity = Eigen::Matrix3Xd::Zero(3, n);
  state.wall_height = cell.moving == MovingWall::bottom ? cell.bottom : cell.top;
  return state;
}

struct Sheared {
  Cell cell;
  State state;
};

/// A rough cell of `grains` loose grains, pressed for `steps` steps: dense, moving, in contact with
/// walls and each other.
inline Sheared pressed(std::size_t grains, std::uint64_t steps,
                       WallTexture walls = WallTexture::rough,
                       MovingWall moving = MovingWall::bottom) {
  Geometry geometry;
  geometry.grains = grains;
  geometry.walls = walls;
  geometry.moving = moving;
  Sheared scene{make_cell(geometry, 7), {}};
  scene.state = fill_cell(scene.cell, geometry, 7);
  Scene forces = table_1();
  forces.gravity = 0;
  SimulationSettings settings;
  settings.limits.overlap = 1;  // the wall comes down on loose grains
  Simulation simulation(scene.cell, forces, scene.state, settings);
  simulation.advance(Drive{}, steps);
  scene.state = simulation.state();
  scene.state.step = 0;
  return scene;
}

/// The state after `steps` steps; by default a sheared cell under Table I.
inline State advanced(const Sheared& start, std::uint64_t steps,
                      const SimulationSettings& settings = {}, const Scene& scene = table_1(),
                      const Drive& drive = {0.0833, 2000, 0}) {
  Simulation simulation(start.cell, scene, start.state, settings);
  simulation.advance(drive, steps);
  return simulation.state();
}

/// The failure in which the work ends.
template <class Work>
NumericalFailure failure_of(Work&& work) {
  try {
    work();
  } catch (const NumericalFailure& failure) {
    return failure;
  }
  throw std::runtime_error("nothing failed");
}

/// Equal to the last bit (so +0 and -0 differ).
inline bool same_bits(const State& a, const State& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) ==
               0;
  };
  const auto wall = [](const State& state) {
    return std::array{state.wall_height, state.wall_velocity};
  };
  return a.step == b.step && equal(a.position, b.position) && equal(a.velocity, b.velocity) &&
         equal(wall(a), wall(b));
}

/// FNV-1a of the bits of everything in a state.
inline std::uint64_t fingerprint(const State& state) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&hash](double value) {
    for (int byte = 0; byte < 8; ++byte) {
      hash = (hash ^ (std::bit_cast<std::uint64_t>(value) >> 8 * byte & 0xFF)) * 0x100000001b3U;
    }
  };
  for (const double value : state.position.reshaped()) add(value);
  for (const double value : state.velocity.reshaped()) add(value);
  add(state.wall_height);
  add(state.wall_velocity);
  add(static_cast<double>(state.step));
  return hash;
}

}  // namespace shearcell::test
