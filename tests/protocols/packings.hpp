// SPDX-License-Identifier: GPL-3.0-or-later
// Settled packings, and the forces in them summed contact by contact.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "core/diagnostics.hpp"
#include "core/filling.hpp"
#include "protocols/settle.hpp"
#include "tests/core/scenes.hpp"

namespace shearcell::test {

struct Packing {
  Cell cell;
  Scene scene;
  State state;
  std::uint64_t pressed = 0;  ///< steps of the phase without gravity
};

inline constexpr std::uint64_t kAtOnce = std::numeric_limits<std::uint64_t>::max();

inline Geometry rough_geometry(std::size_t grains, MovingWall moving = MovingWall::bottom) {
  Geometry geometry;
  geometry.grains = grains;
  geometry.moving = moving;
  return geometry;
}

inline Packing loose(const Geometry& geometry, const Scene& scene, std::uint64_t seed = 1) {
  Packing packing{make_cell(geometry, seed), scene, {}, 0};
  packing.state = fill_cell(packing.cell, geometry, seed);
  return packing;
}

/// Settles to the end, `most_steps` at a time.
inline void settle(Packing& packing, const SettleParameters& parameters = {},
                   std::uint64_t most_steps = kAtOnce) {
  const Settle protocol(parameters, packing.scene);
  Simulation simulation(packing.cell, packing.scene, packing.state);
  packing.pressed = protocol.steps_without_gravity(packing.cell, simulation.grains());
  while (!protocol.advance(simulation, most_steps).finished) {
  }
  packing.state = simulation.state();
}

inline WallPose upright(const Packing& packing) {
  return wall_pose(packing.cell, 0, packing.state.wall_height);
}

/// Forces [m d/s^2] of all contacts of a packing at rest between upright walls.
struct ContactForces {
  Eigen::Matrix3Xd on_grain;                    ///< of contacts alone, without gravity
  std::vector<int> contacts;                    ///< of each grain
  std::map<WallSide, Eigen::Vector3d> of_wall;  ///< on the grains
  double mean = 0;                              ///< magnitude of a contact's force
  double mean_overlap = 0;                      ///< of two grains
  double touches_per_grain = 0;                 ///< with grains and wall grains
};

inline ContactForces forces(const Packing& packing) {
  const Eigen::Index grains = packing.state.position.cols();
  ContactForces f{
      Eigen::Matrix3Xd::Zero(3, grains), std::vector<int>(static_cast<std::size_t>(grains)), {}};
  for (const WallSide side : {WallSide::left, WallSide::right, WallSide::bottom, WallSide::top}) {
    f.of_wall[side].setZero();
  }
  double sum = 0, overlap = 0;
  int contacts = 0, pairs = 0, touches = 0;
  for_each_contact(packing.cell, packing.state.position, upright(packing), [&](const Contact& c) {
    const Eigen::Vector3d force = packing.scene.stiffness * c.overlap * c.normal;
    f.on_grain.col(c.grain) += force;
    ++f.contacts[static_cast<std::size_t>(c.grain)];
    if (c.kind == Contact::Kind::grain) {
      f.on_grain.col(c.other) -= force;
      ++f.contacts[static_cast<std::size_t>(c.other)];
      overlap += c.overlap;
      ++pairs;
      touches += 2;
    } else {
      f.of_wall[c.side] += force;
      touches += c.kind == Contact::Kind::wall_grain ? 1 : 0;
    }
    sum += force.norm();
    ++contacts;
  });
  f.mean = sum / contacts;
  f.mean_overlap = overlap / pairs;
  f.touches_per_grain = touches / static_cast<double>(grains);
  return f;
}

/// P A_w, the load on the moving wall [m d/s^2].
inline double load(const Packing& packing) {
  return packing.scene.pressure * packing.cell.width * packing.cell.depth;
}

}  // namespace shearcell::test
