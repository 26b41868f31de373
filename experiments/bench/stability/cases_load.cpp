// SPDX-License-Identifier: GPL-3.0-or-later
// Pressures, drags and weights from nothing to far beyond those of Table I.
#include <fmt/format.h>

#include <cmath>

#include "core/diagnostics.hpp"
#include "core/minimizer.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

// Nothing holds the wall: it sinks as fast as its drag and that of the grains let their weight.
Outcome no_pressure() {
  Scene scene = table_1();
  scene.pressure = 0;
  const Packing row = row_between_walls(3, scene);
  Simulation simulation(row.cell, scene, row.state);
  simulation.advance(Drive{}, 40000);
  const double area = row.cell.width * row.cell.depth;
  const double speed = -3 * scene.gravity / (scene.wall_drag * area + 3 * scene.drag_rate);
  const State end = simulation.state();
  return all_of({expect_near("speed of the wall", end.wall_velocity, speed, 1e-9),
                 expect_near("of a grain", end.velocity(1, 2), speed, 1e-9)});
}

// One grain between two walls, at the pressure that makes this overlap.
Outcome pressed_grain(double overlap) {
  Scene scene = table_1();
  scene.gravity = 0;
  Packing row = row_between_walls(1, scene);
  scene.pressure = overlap * scene.stiffness / (row.cell.width * row.cell.depth);
  // Slowly, so that the wall does not overshoot.
  scene.wall_drag = 2e4;
  Simulation simulation(row.cell, scene, row.state);
  if (overlap > 0.1) return expect_stop(simulation, Drive{}, 200000, "overlap");
  simulation.advance(Drive{}, 200000);
  const State end = simulation.state();
  return expect_near("overlap", 0.5 - (end.position(1, 0) - end.wall_height), overlap,
                     1e-9 * overlap + 1e-14);
}

Outcome pressed_packing(double ratio) {
  const Packing& packing = settled_packing();
  Scene scene = packing.scene;
  scene.pressure *= ratio;
  if (ratio < 1) scene.gravity = 0;  // for the wall could not carry it
  Simulation simulation(packing.cell, scene, packing.state);
  if (ratio > 5) return expect_stop(simulation, Drive{}, 60000, "overlap");
  if (const auto failure = advance_or_stop(simulation, Drive{}, 60000)) {
    return {false, words(*failure)};
  }
  const State end = simulation.state();
  const Diagnostics facts =
      diagnose(packing.cell, scene, end, wall_pose(packing.cell, 0, end.wall_height));
  return all_of(
      {expect_at_most("largest net force / P d^2", force_residual(packing.cell, scene, end), 1e-5),
       expect_at_most("largest overlap", facts.largest_overlap, 0.1)});
}

// Energy is kept where nothing takes it: a crystal that vibrates with all its contacts closed.
Outcome no_drag(bool quick) {
  Packing packing = crystal(5, 2e-3);
  packing.scene.wall_mass = 1e30;
  Simulation start(packing.cell, packing.scene, packing.state);
  const double at_minimum = total_energy(start);
  for (Eigen::Index i = 0; i < packing.state.velocity.size(); ++i) {
    packing.state.velocity.data()[i] = std::sin(7.0 * static_cast<double>(i * i));
  }
  Simulation simulation(packing.cell, packing.scene, packing.state);
  const double first = mean_energy(simulation, 1000);
  simulation.advance(Drive{}, quick ? 20000 : 1'000'000);
  const double last = mean_energy(simulation, 1000);
  const double momentum =
      simulation.state().velocity.row(2).sum() - packing.state.velocity.row(2).sum();
  return all_of({expect_at_most("energy of the vibration changed by",
                                std::fabs(last - first) / (first - at_minimum), 1e-3),
                 expect_at_most("momentum along z by", std::fabs(momentum), 1e-9)});
}

// Ten thousand times the drag of Table I, b dt/2m = 14: falling at g m/b, and a contact that opens
// as exp(-2 k t / b).
Outcome much_drag() {
  Scene scene = only_springs();
  scene.drag_rate = 64e4;
  const Cell cell = smooth_cell(40, 40, 40);
  constexpr double overlap = 0.05;
  Simulation pair(cell, scene, at_rest(cell, {{20, 20, 20}, {21 - overlap, 20, 20}}));
  pair.advance(Drive{}, 200);
  // From rest half a step earlier the velocity rings once up and down, which shifts the time by
  // (b dt/2m - 1) / (b dt/m) of a step; the grain's inertia adds a relative 2 k m / b^2 = 1.6e-4.
  const double step = scene.drag_rate * scene.time_step;
  const double time = (200 + (0.5 * step - 1) / step) * scene.time_step;
  const double right = overlap * std::exp(-2 * scene.stiffness / scene.drag_rate * time);
  const Eigen::Matrix3Xd at = pair.state().position;
  scene.gravity = table_1().gravity;
  Simulation fall(cell, scene, at_rest(cell, {{20, 20, 20}}));
  fall.advance(Drive{}, 1000);
  return all_of({expect_near("overlap", 1 - (at(0, 1) - at(0, 0)), right, 3e-4 * right),
                 expect_near("falls at", -fall.state().velocity(1, 0),
                             scene.gravity / scene.drag_rate, 1e-12)});
}

Outcome heavy_grain(double ratio) {
  Scene scene = only_springs();
  scene.gravity = ratio * table_1().gravity;
  scene.drag_rate = 640;
  const Cell cell = smooth_cell(4, 4, 4);
  Simulation simulation(cell, scene, at_rest(cell, {{2, 0.5, 2}}));
  simulation.advance(Drive{}, 20000);
  return expect_near("overlap with the wall", 0.5 - simulation.state().position(1, 0),
                     scene.gravity / scene.stiffness, 1e-12);
}

// Twelve grains stacked in a shaft: the lowest would carry twelve times 100 m g, an overlap of
// 0.12.
Outcome heavy_stack() {
  Scene scene = only_springs();
  scene.gravity = 100 * table_1().gravity;
  scene.drag_rate = 640;
  const Cell cell = smooth_cell(4, 14, 4);
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 12; ++i) positions.emplace_back(2, 0.5 + i, 2);
  Simulation simulation(cell, scene, at_rest(cell, positions));
  return expect_stop(simulation, Drive{}, 40000, "overlap");
}

Outcome no_gravity() {
  Packing packing = settled_packing();
  packing.scene.gravity = 0;
  Simulation simulation(packing.cell, packing.scene, packing.state);
  simulation.advance(Drive{}, 100000);
  return expect_at_most("largest net force / P d^2",
                        force_residual(packing.cell, packing.scene, simulation.state()), 1e-5);
}

Outcome light_wall() {
  Packing packing = settled_packing();
  packing.scene.wall_mass = 0.01;
  Simulation simulation(packing.cell, packing.scene, packing.state);
  return expect_stop(simulation, Drive{}, 20000, "time step");
}

}  // namespace

Cases load_cases() {
  Cases cases = {{"pressure-0", "three grains on the moving wall, P = 0",
                  "all sink at 3 m g / (B A + 3 b)", [](bool) { return no_pressure(); }}};
  for (const double overlap : {1e-6, 1e-3, 0.05, 0.099, 0.101, 0.3}) {
    cases.push_back({fmt::format("pressure-overlap-{:g}", overlap),
                     fmt::format("a grain under P = {:g} k d / A", overlap),
                     overlap > 0.1 ? "stopped: the overlap over its limit" : "that overlap",
                     [overlap](bool) { return pressed_grain(overlap); }});
  }
  for (const double ratio : {0.01, 3.0, 10.0, 100.0}) {
    cases.push_back({fmt::format("pressure-packing-{:g}", ratio),
                     fmt::format("a packing under {:g} times the pressure of Table I", ratio),
                     ratio > 5 ? "stopped: the overlap over its limit" : "all forces in balance",
                     [ratio](bool) { return pressed_packing(ratio); }});
  }
  const Cases more = {
      {"drag-0", "a crystal vibrates 1e6 steps without drag", "energy and momentum are kept",
       no_drag},
      {"drag-1e4", "ten thousand times the drag of Table I", "creeps and falls as b alone lets it",
       [](bool) { return much_drag(); }},
      {"gravity-0", "a packing whose weight is taken away", "all forces in balance",
       [](bool) { return no_gravity(); }},
      {"gravity-100g", "a grain of 100 times its weight on a wall", "overlap m g / k",
       [](bool) {
         return all_of({heavy_grain(1), heavy_grain(100)});
       }},
      {"gravity-100g-stack", "twelve such grains on each other",
       "stopped: the overlap over its limit", [](bool) { return heavy_stack(); }},
      {"light-wall", "a moving wall of 0.01 m for each d^2",
       "stopped: the time step over the limit of the wall", [](bool) { return light_wall(); }},
  };
  cases.insert(cases.end(), more.begin(), more.end());
  return cases;
}

}  // namespace shearcell::stability
