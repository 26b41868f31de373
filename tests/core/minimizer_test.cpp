// SPDX-License-Identifier: GPL-3.0-or-later
// Minima of the enthalpy: known ones, and that of a packing. Its bits: reproducible_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "core/diagnostics.hpp"
#include "core/random.hpp"
#include "tests/core/golden.hpp"
#include "tests/support/text.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

constexpr double kTolerance = 1e-8;

// Smooth, 4 d wide and deep, the top wall pressing from `top`.
Cell column(double top) {
  Cell cell;
  cell.width = cell.depth = 4;
  cell.top = top;
  cell.moving = MovingWall::top;
  return cell;
}

State minimized(const Cell& cell, const Scene& scene, const State& state,
                double tolerance = kTolerance) {
  Simulation simulation(cell, scene, state);
  minimize_enthalpy(simulation, {.force_tolerance = tolerance});
  return simulation.state();
}

TEST(Minimizer, AGrainRestsOnThePlaneThatCarriesIt) {
  Scene scene = table_1();
  scene.pressure = 0;
  const Cell cell = column(40);
  const State end = minimized(cell, scene, at_rest({{2, 0.6, 2}}, cell));
  const double overlap = 0.5 - end.position(1, 0);
  std::printf("overlap %.12g, m g / k = %.12g\n", overlap, scene.gravity / scene.stiffness);
  EXPECT_NEAR(overlap / (scene.gravity / scene.stiffness), 1, 2 * kTolerance);
  EXPECT_EQ(end.position(0, 0), 2);
  EXPECT_EQ(end.wall_height, 40) << "nothing acts on the wall";
  EXPECT_EQ(end.velocity.norm(), 0);
  EXPECT_EQ(end.step, 1U);
}

TEST(Minimizer, TwoGrainsCarryAPressedWall) {
  for (const auto& [moving, at] : {std::pair(MovingWall::top, PressureAt::moving_wall),
                                   std::pair(MovingWall::top, PressureAt::top),
                                   std::pair(MovingWall::bottom, PressureAt::moving_wall),
                                   std::pair(MovingWall::bottom, PressureAt::top)}) {
    Scene scene = table_1();
    scene.pressure_at = at;
    Cell cell = column(2.05);
    cell.moving = moving;
    const State end = minimized(cell, scene, at_rest({{2, 0.5, 2}, {2, 1.5, 2}}, cell));
    // The overlaps at the bottom, between the grains and at the top carry P A at one end and the
    // weight of the grains between.
    const double load = scene.pressure * 16;
    const double weight = scene.gravity;
    const bool lifts = moving == MovingWall::bottom;
    const double at_top = load - (lifts && at == PressureAt::moving_wall ? 2 * weight : 0);
    const double bottom = lifts ? end.wall_height : 0, top = lifts ? 2.05 : end.wall_height;
    const double k = scene.stiffness;
    const double tolerance = kTolerance * scene.pressure * 16;
    EXPECT_NEAR(k * (0.5 - (end.position(1, 0) - bottom)), at_top + 2 * weight, 2 * tolerance);
    EXPECT_NEAR(k * (1 - (end.position(1, 1) - end.position(1, 0))), at_top + weight,
                2 * tolerance);
    EXPECT_NEAR(k * (0.5 - (top - end.position(1, 1))), at_top, 2 * tolerance);
    EXPECT_LT(force_residual(cell, scene, end), 1.01 * kTolerance);
  }
}

// H [m d^2/s^2] between upright walls, contact by contact. Gravity counts from y = 0.
double enthalpy(const Cell& cell, const Scene& scene, const State& state) {
  const WallPose pose = wall_pose(cell, 0, state.wall_height);
  const auto grains = static_cast<std::size_t>(state.position.cols());
  double sum = (scene.pressure * cell.width * cell.depth + carried_weight(scene, cell, grains)) *
                   (pose.top - pose.bottom) +
               scene.gravity * state.position.row(1).sum();
  for_each_contact(cell, state.position, pose,
                   [&](const Contact& c) { sum += 0.5 * scene.stiffness * c.overlap * c.overlap; });
  return sum;
}

// Every coordinate and the wall displaced at random by up to `size`.
State shaken(State state, double size, std::uint32_t trial) {
  const auto random = [trial](std::uint32_t n) {
    return 2 * uniform_pair({n, trial, 0, 0}, 5)[0] - 1;
  };
  for (Eigen::Index n = 0; n < state.position.size(); ++n) {
    state.position.data()[n] += size * random(static_cast<std::uint32_t>(n) + 1);
  }
  state.wall_height += size * random(0);
  return state;
}

TEST(Minimizer, APackingEndsAtALocalMinimumOfTheEnthalpy) {
  const auto& [cell, start] = small_packing();
  const Scene scene = table_1();
  const State end = minimized(cell, scene, start);
  const double residual = force_residual(cell, scene, end);
  const double before = enthalpy(cell, scene, start), after = enthalpy(cell, scene, end);
  std::printf("residual %.3g, then %.3g; enthalpy %.8g, then %.12g\n",
              force_residual(cell, scene, start), residual, before, after);
  EXPECT_LE(residual, 1.01 * kTolerance) << "the kernel's contact law is rounded differently";
  EXPECT_LT(after, before);
  // Small random displacements only raise it.
  double least = 1e9;
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    least = std::min(least, enthalpy(cell, scene, shaken(end, 1e-5, trial)) - after);
  }
  std::printf("least rise of 20 displacements: %.3g\n", least);
  EXPECT_GT(least, 0);
  for (const double factor : {1.8, 0.6}) {
    Scene changed = scene;
    changed.stiffness *= factor;
    const State other = minimized(cell, changed, start, 1e-4);
    EXPECT_LT(enthalpy(cell, changed, other), enthalpy(cell, changed, start)) << factor;
  }
}

TEST(Minimizer, FailsIfTheToleranceIsUnreachable) {
  const auto& [cell, start] = small_packing();
  const Scene scene = table_1();
  Simulation simulation(cell, scene, start);
  MinimizeSettings settings;
  settings.force_tolerance = 1e-30;
  settings.most_evaluations = 500;
  expect_refused<NumericalFailure>([&] { minimize_enthalpy(simulation, settings); },
                                   {"minimize_force_tolerance"});
}

// The forces of grains at one place are not numbers, and no other force is over the tolerance.
TEST(Minimizer, FailsIfGrainsAreAtOnePlace) {
  const Cell cell = open_cell();
  EXPECT_THROW(minimized(cell, only_contacts(), at_rest({{9, 9, 9}, {9, 9, 9}}, cell)),
               NumericalFailure);
}

TEST(Simulation, ContinuesFromASetState) {
  const auto& [cell, start] = small_packing();
  const Scene scene = table_1();
  Simulation straight(cell, scene, start);
  straight.advance({}, 500);
  Simulation other(cell, scene, straight.state());
  other.advance({}, 300);
  other.set_state(start);
  EXPECT_TRUE(same_bits(other.state(), start));
  other.advance({}, 500);
  EXPECT_TRUE(same_bits(other.state(), straight.state()));
  EXPECT_EQ(other.evaluations(), 800U);
  State fewer = start;
  fewer.position.conservativeResize(3, 5);
  EXPECT_THROW(other.set_state(fewer), std::invalid_argument);
}

// With a drag of 2/dt a step keeps nothing of the velocity: v' = dt F / 2.
TEST(Simulation, ForcesAreThoseOfAStep) {
  const auto& [cell, rest] = small_packing();
  const Scene scene = table_1();
  const State start = shaken(rest, 1e-2, 0);
  Scene thick = scene;
  thick.drag_rate = 2 / scene.time_step;
  Simulation simulation(cell, thick, start);
  const Eigen::Matrix3Xd forces = simulation.forces().on_grain;
  EXPECT_TRUE(same_bits(simulation.state(), start)) << "asking changes nothing";
  simulation.advance({}, 1);
  const double largest = forces.colwise().norm().maxCoeff();
  EXPECT_GT(largest, scene.pressure);
  const double error = (simulation.state().velocity * 2 / scene.time_step - forces).norm();
  std::printf("largest force %.3g, difference of all %.3g\n", largest, error);
  EXPECT_LT(error, 1e-9 * largest);
}

}  // namespace
}  // namespace shearcell
