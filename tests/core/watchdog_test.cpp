// SPDX-License-Identifier: GPL-3.0-or-later
// A run that fails stops and reports where and why.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/simulation.hpp"
#include "tests/core/scenes.hpp"
#include "tests/support/text.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

NumericalFailure failure_of(const Cell& cell, const Scene& scene, const State& state,
                            std::uint64_t steps = 1, const SimulationSettings& settings = {}) {
  Simulation simulation(cell, scene, state, settings);
  return test::failure_of([&] { simulation.advance(Drive{}, steps); });
}

TEST(Watchdog, StopsNotANumber) {
  State state = at_rest({{20, 20, 20}, {10, 10, 10}}, open_cell());
  state.velocity(1, 1) = std::nan("");
  EXPECT_EQ(failure_of(open_cell(), table_1(), state).grain, 1);
}

// A wall whose height is NaN touches nothing, so no other check fails.
TEST(Watchdog, StopsAWallWithoutAFinitePosition) {
  for (const bool height : {true, false}) {
    State state = at_rest({{20, 20, 20}}, open_cell());
    (height ? state.wall_height : state.wall_velocity) = std::nan("");
    const NumericalFailure failure = failure_of(open_cell(), table_1(), state, 1024);
    EXPECT_TRUE(has(failure.quantity, "moving wall"));
  }
}

TEST(Watchdog, StopsAGrainThatLeaves) {
  Scene scene = only_contacts();
  scene.stiffness = 1e-3;
  scene.gravity = 3270;
  scene.time_step = 1e-5;
  State state = at_rest({{20, 1, 20}}, open_cell());
  state.velocity(1, 0) = -1e-3;  // slow enough for so weak a wall, but nothing stops it
  SimulationSettings settings;
  settings.limits.overlap = 1e4;  // only the escape counts here
  const NumericalFailure failure = failure_of(open_cell(), scene, state, 20000, settings);
  EXPECT_TRUE(has(failure.quantity, "behind a wall"));
}

TEST(Watchdog, StopsGrainsPressedIntoAWallPlane) {
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(20, 0.39, 20), Eigen::Vector3d(0.39, 20, 20),
        Eigen::Vector3d(39.61, 20, 20), Eigen::Vector3d(20, 39.61, 1)}) {
    const NumericalFailure failure =
        failure_of(open_cell(), table_1(), at_rest({place}, open_cell()));
    EXPECT_TRUE(has(failure.quantity, "a wall plane"));
    EXPECT_NEAR(failure.value, 0.11, 1e-12);
  }
}

// They fly apart within the steps between two checks, and drag slows them down before the next: so
// a new state is checked before its first step.
TEST(Watchdog, StopsOverlapsOverTheLimitBeforeTheFirstStep) {
  const auto pair = [](double apart) {
    return at_rest({{20, 20, 20}, {20 + apart, 20, 20}}, open_cell());
  };
  for (const double apart : {0.0, 1e-300, 1e-9, 0.5, 0.89}) {
    const NumericalFailure failure = failure_of(open_cell(), table_1(), pair(apart));
    EXPECT_NEAR(failure.value, 1 - apart, 1e-12);
    EXPECT_EQ(failure.limit, 0.1);
    EXPECT_EQ(failure.step, 0U);
  }
  SimulationSettings strict;
  strict.limits.overlap = 1e-4;
  EXPECT_EQ(failure_of(open_cell(), table_1(), pair(0.999), 1, strict).limit, 1e-4);
  Simulation again(open_cell(), table_1(), pair(2));
  again.advance(Drive{}, 10);
  again.set_state(pair(0.5));
  EXPECT_NEAR(test::failure_of([&] { again.advance(Drive{}, 1); }).value, 0.5, 1e-12);
}

// Whether a run fails must not depend on where it was recorded, stopped or continued.
TEST(Watchdog, ChecksTheSameStepsWhereverARunIsContinued) {
  State pressed_together = at_rest({{20, 20, 20}, {20.5, 20, 20}}, open_cell());
  pressed_together.step = 1000;
  Scene scene = table_1();
  scene.time_step = 1e-9;  // the grains do not part
  Simulation continued(open_cell(), scene, pressed_together);
  continued.advance(Drive{}, 23);
  continued.check_recordable();
  EXPECT_THROW(continued.check(), NumericalFailure);
  EXPECT_EQ(test::failure_of([&] { continued.advance(Drive{}, 1); }).step, 1024U);

  State lost = at_rest({{20, 20, 20}, {20, 10, 20}}, open_cell());
  lost.step = 1;
  lost.velocity(0, 1) = std::nan("");
  Simulation of_lost(open_cell(), scene, lost);
  of_lost.advance(Drive{}, 1);
  EXPECT_EQ(test::failure_of([&] { of_lost.check_recordable(); }).grain, 1);
}

// Drag hides the instability: at 1.3 times 2/sqrt(8 k/m) the grains vibrate without end, with
// plausible overlaps and speeds.
TEST(Watchdog, StopsAnUnstableTimeStepThatDragHides) {
  const Sheared packing = pressed(300, 9000);
  const auto& cell = packing.cell;
  const auto& start = packing.state;
  Scene scene = table_1();
  scene.time_step = 1.3 * 2 / std::sqrt(8 * scene.stiffness);
  const auto energy_at_end = [&](const SimulationSettings& settings) {
    Simulation simulation(cell, scene, start, settings);
    simulation.advance(Drive{}, 20000);
    return 0.5 * simulation.state().velocity.squaredNorm() / 300;
  };
  SimulationSettings blind;
  blind.limits.time_step = 1e9;
  const double kinetic = energy_at_end(blind);
  EXPECT_GT(kinetic, 1) << "of a packing that should be at rest";

  const NumericalFailure failure = failure_of(cell, scene, start);
  std::printf("kinetic energy per grain %.3g; %s\n", kinetic, failure.what());
  EXPECT_EQ(failure.quantity, "the time step [s]");
  EXPECT_GE(failure.grain, 0);
  EXPECT_TRUE(has(failure.what(), "smaller time step"));
  EXPECT_LT(failure.limit, 1.2 / 1.3 * scene.time_step);
  // At the limit that it names the same packing comes to rest.
  scene.time_step = 0.99 * failure.limit;
  EXPECT_LT(energy_at_end({}), 1e-6);

  Scene light = table_1();
  light.wall_mass = 1e-3;
  const NumericalFailure of_wall = failure_of(cell, light, start);
  EXPECT_EQ(of_wall.grain, -1);
  EXPECT_TRUE(has(of_wall.what(), "heavier wall"));
}

TEST(Watchdog, BoundsAPairByItsOwnFrequency) {
  const State state = at_rest({{20, 20, 20}, {20.3, 20.6, 20.7}}, open_cell());
  Scene scene = only_contacts();
  const double limit = 2 / std::sqrt(2 * scene.stiffness);
  scene.time_step = 0.999 * limit;
  Simulation(open_cell(), scene, state).advance(Drive{}, 1);
  scene.time_step = 1.001 * limit;
  EXPECT_NEAR(failure_of(open_cell(), scene, state).limit, limit, 1e-12 * limit);
}

TEST(Simulation, ZeroesVelocitiesTooSmallToMoveAGrain) {
  Scene scene = only_contacts();
  State state = at_rest({{10, 20, 20}, {20, 20, 20}, {30, 20, 20}}, open_cell());
  state.velocity.col(0) << 1e-310, -1e-320, 0;
  state.velocity.col(1) << 1e-305, -0x1p-1000, 1;
  state.velocity.col(2) << 0x1p-1001, -1, 1e-290;
  scene.time_step = 1e-9;
  Simulation simulation(open_cell(), scene, state);
  simulation.advance(Drive{}, 1023);
  EXPECT_EQ(simulation.state().velocity, state.velocity);
  simulation.advance(Drive{}, 1);
  state.velocity.col(0).setZero();
  state.velocity(0, 1) = state.velocity(0, 2) = 0;
  EXPECT_EQ(simulation.state().velocity, state.velocity);
}

TEST(Simulation, RejectsInvalidStates) {
  State state = at_rest({{20, 20, 20}}, open_cell());
  state.velocity.resize(3, 2);
  EXPECT_THROW(Simulation(open_cell(), table_1(), state), std::invalid_argument);
  EXPECT_THROW(Simulation(open_cell(), table_1(), State{}), std::invalid_argument);
  const Cell shallow = open_cell(2.5);
  EXPECT_THROW(Simulation(shallow, table_1(), at_rest({{1, 1, 1}}, shallow)),
               std::invalid_argument);
}

}  // namespace
}  // namespace shearcell
