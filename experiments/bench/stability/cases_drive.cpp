// SPDX-License-Identifier: GPL-3.0-or-later
// Amplitudes of the shear from a millionth of a radian to half of one.
#include <fmt/format.h>

#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

// A cycle of 2000 steps is 23 times as fast as that of Table I. Beyond some hundred steps the
// rounding of two ways to sum has grown by what grains that jostle make of it.
Outcome against_all_pairs(double amplitude, std::uint64_t start, Fluid fluid) {
  const Packing& packing = settled_packing();
  const Drive drive{amplitude, 2000, 0};
  Scene scene = packing.scene;
  scene.fluid = fluid;
  Simulation simulation(packing.cell, scene, packing.state);
  simulation.advance(drive, start);
  State right = simulation.state();
  simulation.advance(drive, 200);
  advance_all_pairs(packing.cell, scene, drive, 200, right);
  const double moved = largest_difference(right, packing.state);
  return expect_at_most(fmt::format("moved by {:.3g} at step {}, otherwise by", moved, right.step),
                        largest_difference(simulation.state(), right), 1e-10);
}

Outcome shear(double amplitude) {
  return all_of({against_all_pairs(amplitude, 0, Fluid::still),
                 against_all_pairs(amplitude, 400, Fluid::still),
                 against_all_pairs(amplitude, 400, Fluid::cell),
                 against_all_pairs(amplitude, 1400, Fluid::cell)});
}

// A grain that two leaning walls hold stays half way between them.
Outcome held_grain(double amplitude) {
  constexpr double overlap = 1e-3;
  const Cell cell = smooth_cell(1 - 2 * overlap, 4, 4);
  Scene scene = only_springs();
  scene.drag_rate = 640;
  Simulation simulation(cell, scene, at_rest(cell, {{0.5 - overlap, 1, 2}}));
  const Drive drive{amplitude, 400000, 0};
  simulation.advance(drive, 100000);
  const double tangent = wall_pose(cell, tilt(drive, 100000).theta, 0).tan_theta;
  const Eigen::Vector3d at = simulation.state().position.col(0);
  return expect_near("leans by", at.x() - (0.5 - overlap), tangent * (at.y() - cell.top),
                     1e-6 * amplitude);
}

}  // namespace

Cases drive_cases() {
  Cases cases;
  for (const double amplitude : {1e-6, 1e-4, 1e-2, 0.0833, 0.5}) {
    cases.push_back({fmt::format("amplitude-{:g}", amplitude),
                     fmt::format("a packing sheared by {:g} rad", amplitude),
                     "as by the sum over all pairs and images; a held grain follows the walls",
                     [amplitude](bool) {
                       return all_of({shear(amplitude), held_grain(amplitude)});
                     }});
  }
  return cases;
}

}  // namespace shearcell::stability
