// SPDX-License-Identifier: GPL-3.0-or-later
// Grains placed where nothing places them by itself, and impacts at the speed of the time step.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

using V = Eigen::Vector3d;

Outcome two_apart(double apart) {
  const Cell cell = smooth_cell(40, 40, 40);
  Simulation simulation(cell, table_1(), at_rest(cell, {{20, 20, 20}, {20 + apart, 20, 20}}));
  return expect_stop(simulation, Drive{}, 1, "the overlap [d] of two grains");
}

Outcome stays(const std::vector<V>& positions) {
  const Cell cell = smooth_cell(40, 40, 40);
  const State start = at_rest(cell, positions);
  Simulation simulation(cell, only_springs(), start);
  simulation.advance(Drive{}, 5000);
  const State end = simulation.state();
  const auto bytes = sizeof(double) * static_cast<std::size_t>(end.position.size());
  const bool same = std::memcmp(end.position.data(), start.position.data(), bytes) == 0;
  return {same,
          same ? "no bit moved" : fmt::format("moved by {:.2g}", largest_difference(end, start))};
}

Outcome on_plane() {
  const Cell cell = smooth_cell(40, 40, 40);
  std::vector<Outcome> parts;
  for (const V& place : {V(20, 0, 20), V(0, 20, 20), V(40, 20, 20), V(20, 40, 20)}) {
    Simulation simulation(cell, table_1(), at_rest(cell, {place}));
    parts.push_back(expect_stop(simulation, Drive{}, 1, "wall plane"));
  }
  return all_of(parts);
}

// Two planes push along their own normals: each direction is half an oscillation of its own.
Outcome corner() {
  const Cell cell = smooth_cell(40, 40, 40);
  Scene scene = only_springs();
  scene.time_step /= 10;
  const V into(0.08, 0.05, 0);
  Simulation simulation(cell, scene, at_rest(cell, {V(0.5, 0.5, 20) - into}));
  simulation.advance(Drive{}, 1000);
  const V v = simulation.state().velocity.col(0), right = std::sqrt(scene.stiffness) * into;
  return all_of({expect_near("leaves at", v.x(), right.x(), 2e-3 * right.x()),
                 expect_near("and", v.y(), right.y(), 2e-3 * right.y()),
                 expect_near("along z", v.z(), 0, 0)});
}

// The same collision in the middle of the cell and across the seam, once and twice around.
Outcome seam() {
  const Cell cell = smooth_cell(40, 40, 40);
  Scene scene = only_springs();
  const auto collide = [&](double z) {
    State state = at_rest(cell, {{20, 20, z - 0.53}, {20.1, 20.2, z + 0.53}});
    state.velocity.row(2) << 40, -60;
    Simulation simulation(cell, scene, state);
    simulation.advance(Drive{}, 100);
    return simulation.state();
  };
  const State right = collide(20);
  std::vector<Outcome> parts;
  for (const double z : {0.0, 40.0, -40.0, 80.1}) {
    State state = collide(z);
    state.position.row(2).array() += 20 - z;
    parts.push_back(expect_at_most(fmt::format("around z = {:g} moved otherwise by", z),
                                   largest_difference(state, right), 1e-11));
  }
  parts.push_back(expect_near("momentum", right.velocity.row(2).sum(), -20, 1e-12));
  return all_of(parts);
}

// A look of the watchdog before the first step sees what the first step would step over.
Outcome head_on(double diameters_per_step) {
  const Cell cell = smooth_cell(40, 40, 40);
  const Scene scene = only_springs();
  const double speed = diameters_per_step / scene.time_step;
  State state = at_rest(cell, {{18.9, 20, 20}, {21.1, 20.2, 20.3}});
  state.velocity.row(0) << speed, -speed;
  Simulation simulation(cell, scene, state);
  if (diameters_per_step > 0.1) return expect_stop(simulation, Drive{}, 1, "speed");
  simulation.advance(Drive{}, 60);
  State right = state;
  advance_all_pairs(cell, scene, Drive{}, 60, right);
  const State end = simulation.state();
  return all_of({expect_at_most("moved otherwise than by all pairs by",
                                largest_difference(end, right), 1e-11),
                 expect_near("momentum / speed", end.velocity.row(0).sum() / speed, 0, 1e-13),
                 expect_near("energy kept", kinetic_energy(end) / kinetic_energy(state), 1, 0.05)});
}

// Newton's cradle, one contact at a time.
Outcome flies_into_row() {
  const Cell cell = smooth_cell(40, 40, 40);
  Scene scene = only_springs();
  std::vector<V> positions;
  for (int i = 0; i < 8; ++i) positions.emplace_back(20 + i, 20, 20);
  positions.emplace_back(15.05, 20, 20);
  State state = at_rest(cell, positions);
  state.velocity(0, 8) = 0.01 / scene.time_step;
  Simulation simulation(cell, scene, state);
  State right = state;
  simulation.advance(Drive{}, 800);
  advance_all_pairs(cell, scene, Drive{}, 800, right);
  return all_of(
      {expect_at_most("moved otherwise than by all pairs by",
                      largest_difference(simulation.state(), right), 1e-10),
       expect_at_most("the grain that flew keeps of its speed",
                      std::fabs(simulation.state().velocity(0, 8)) / state.velocity(0, 8), 0.5),
       expect_near("momentum kept", simulation.state().velocity.row(0).sum() / state.velocity(0, 8),
                   1, 1e-12)});
}

}  // namespace

Cases placement_cases() {
  const std::string overlapping = "stopped before the first step: the overlap over its limit";
  return {
      {"equal-positions", "two grains at one place", overlapping,
       [](bool) { return two_apart(0); }},
      {"nearly-equal-positions", "two grains 1e-300 and 1e-9 d apart", overlapping,
       [](bool) {
         return all_of({two_apart(1e-300), two_apart(1e-9)});
       }},
      {"touching", "three grains that touch exactly", "stay",
       [](bool) {
         return stays({{20, 20, 20}, {21, 20, 20}, {22, 20, 20}});
       }},
      {"touching-seam", "grains that touch exactly across the seam", "stay",
       [](bool) {
         return stays({{20, 20, 0}, {20, 20, 39}, {20, 20, 38}, {10, 9, 40}, {10, 9, 1}});
       }},
      {"touching-walls", "grains that touch a wall, or two, exactly", "stay",
       [](bool) {
         return stays({{0.5, 20, 20}, {20, 0.5, 20}, {0.5, 0.5, 5}, {39.5, 39.5, 9}});
       }},
      {"on-wall-plane", "a grain with its centre on each of the wall planes",
       "stopped before the first step: the overlap with the plane over its limit",
       [](bool) { return on_plane(); }},
      {"corner", "a grain pressed into a corner and let go", "leaves at overlap times sqrt(k/m)",
       [](bool) { return corner(); }},
      {"seam", "an oblique collision across the periodic seam", "as in the middle of the cell",
       [](bool) { return seam(); }},
      {"head-on-1", "two grains meet, each at one diameter per step",
       "stopped before the first step: the speed over its limit", [](bool) { return head_on(1); }},
      {"head-on-0.02", "the same at a fiftieth of that", "as by the sum over all pairs",
       [](bool) { return head_on(0.02); }},
      {"impact-row", "a grain flies into a row of eight", "as by the sum over all pairs",
       [](bool) { return flies_into_row(); }},
  };
}

}  // namespace shearcell::stability
