// SPDX-License-Identifier: GPL-3.0-or-later
// A run that goes wrong stops, and says where and why.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "core/simulation.hpp"
#include "tests/core/scenes.hpp"

namespace shearcell {
namespace {

NumericalFailure failure_of(Simulation& simulation, std::uint64_t steps) {
  try {
    simulation.advance(Drive{}, steps);
  } catch (const NumericalFailure& failure) {
    return failure;
  }
  throw std::runtime_error("nothing failed");
}

TEST(Watchdog, StopsATimeStepBeyondTheStabilityLimit) {
  const test::Sheared start = test::pressed(300, 9000);
  Scene scene = test::table_1();
  scene.time_step *= 5;
  Simulation simulation(start.cell, scene, start.state);
  const NumericalFailure failure = failure_of(simulation, 20000);
  EXPECT_GT(failure.value, failure.limit);
  EXPECT_GE(failure.grain, 0);
  EXPECT_NE(std::string(failure.what()).find("smaller time step"), std::string::npos)
      << failure.what();
}

TEST(Watchdog, StopsNotANumber) {
  const Cell cell = test::open_cell();
  State state = test::at_rest({{20, 20, 20}, {10, 10, 10}}, cell);
  state.velocity(1, 1) = std::nan("");
  Simulation simulation(cell, test::table_1(), state);
  EXPECT_EQ(failure_of(simulation, 2000).grain, 1);
}

TEST(Watchdog, StopsAGrainThatLeaves) {
  Scene scene = test::only_contacts();
  scene.stiffness = 1e-3;
  const Cell cell = test::open_cell();
  State state = test::at_rest({{20, 1, 20}}, cell);
  state.velocity(1, 0) = -1e-3;  // slow enough for so weak a wall, but nothing stops it
  scene.gravity = 3270;
  scene.time_step = 1e-5;
  EngineSettings settings;
  settings.limits.overlap = 1e4;  // only the escape counts here
  Simulation simulation(cell, scene, state, settings);
  const NumericalFailure failure = failure_of(simulation, 20000);
  EXPECT_NE(failure.quantity.find("behind a wall"), std::string::npos) << failure.what();
}

TEST(Watchdog, StopsOverlapsOverTheLimit) {
  const test::Sheared start = test::pressed(300, 9000);
  EngineSettings settings;
  settings.limits.overlap = 1e-4;
  Simulation simulation(start.cell, test::table_1(), start.state, settings);
  const NumericalFailure failure = failure_of(simulation, 2000);
  EXPECT_GT(failure.value, 1e-4);
}

// Drag hides the instability: at 1.3 times 2/sqrt(8 k/m) the grains shake for ever, with overlaps
// and speeds that look sound.
TEST(Watchdog, StopsATimeStepThatDragKeepsFromBlowingUp) {
  test::Sheared start = test::pressed(300, 9000);
  Scene scene = test::table_1();
  scene.time_step = 1.3 * 2 / std::sqrt(8 * scene.stiffness);
  EngineSettings blind;
  blind.limits.time_step = 1e9;
  Simulation unwatched(start.cell, scene, start.state, blind);
  unwatched.advance(Drive{}, 20000);
  const double kinetic = 0.5 * unwatched.state().velocity.squaredNorm() / 300;
  EXPECT_GT(kinetic, 1) << "of a packing that should be at rest";

  Simulation simulation(start.cell, scene, start.state);
  const NumericalFailure failure = failure_of(simulation, 1);
  std::printf("kinetic energy per grain %.3g; %s\n", kinetic, failure.what());
  EXPECT_EQ(failure.quantity, "the time step [s]");
  EXPECT_LT(failure.limit, 1.2 / 1.3 * scene.time_step);
  // At the limit that it names the same packing comes to rest.
  scene.time_step = 0.99 * failure.limit;
  Simulation sound(start.cell, scene, start.state);
  sound.advance(Drive{}, 20000);
  EXPECT_LT(0.5 * sound.state().velocity.squaredNorm() / 300, 1e-6);
}

TEST(Watchdog, BoundsAPairByItsOwnFrequency) {
  const Cell cell = test::open_cell();
  const State state = test::at_rest({{20, 20, 20}, {20.3, 20.6, 20.7}}, cell);
  Scene scene = test::only_contacts();
  const double limit = 2 / std::sqrt(2 * scene.stiffness);
  scene.time_step = 0.999 * limit;
  Simulation(cell, scene, state).advance(Drive{}, 1);
  scene.time_step = 1.001 * limit;
  Simulation simulation(cell, scene, state);
  EXPECT_NEAR(failure_of(simulation, 1).limit, limit, 1e-12 * limit);
}

TEST(Watchdog, StopsAMovingWallThatIsTooLight) {
  const test::Sheared start = test::pressed(300, 9000);
  Scene scene = test::table_1();
  scene.wall_mass = 1e-3;
  Simulation simulation(start.cell, scene, start.state);
  const NumericalFailure failure = failure_of(simulation, 1);
  EXPECT_EQ(failure.grain, -1);
  EXPECT_NE(std::string(failure.what()).find("heavier wall"), std::string::npos) << failure.what();
}

// They fly apart within the steps between two looks, and drag slows them down before the next.
TEST(Watchdog, LooksAtWhatItIsGiven) {
  const Cell cell = test::open_cell();
  for (const double apart : {0.0, 1e-300, 1e-9, 0.5}) {
    Simulation simulation(cell, test::table_1(),
                          test::at_rest({{20, 20, 20}, {20 + apart, 20, 20}}, cell));
    const NumericalFailure failure = failure_of(simulation, 1);
    EXPECT_NEAR(failure.value, 1 - apart, 1e-12);
    EXPECT_EQ(failure.step, 0U);
  }
  Simulation again(cell, test::table_1(), test::at_rest({{20, 20, 20}, {22, 20, 20}}, cell));
  again.advance(Drive{}, 10);
  again.set_state(test::at_rest({{20, 20, 20}, {20.5, 20, 20}}, cell));
  EXPECT_NEAR(failure_of(again, 1).value, 0.5, 1e-12);
}

TEST(Watchdog, StopsGrainsPressedIntoAWallPlane) {
  const Cell cell = test::open_cell();
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(20, 0.39, 20), Eigen::Vector3d(0.39, 20, 20),
        Eigen::Vector3d(39.61, 20, 20), Eigen::Vector3d(20, 39.61, 1)}) {
    Simulation simulation(cell, test::table_1(), test::at_rest({place}, cell));
    const NumericalFailure failure = failure_of(simulation, 1);
    EXPECT_NE(failure.quantity.find("a wall plane"), std::string::npos) << failure.what();
    EXPECT_NEAR(failure.value, 0.11, 1e-12);
  }
}

// A wall at no height touches nothing, and so hides that anything is wrong.
TEST(Watchdog, StopsAWallThatIsNowhere) {
  const Cell cell = test::open_cell();
  for (const bool height : {true, false}) {
    State state = test::at_rest({{20, 20, 20}}, cell);
    (height ? state.wall_height : state.wall_velocity) = std::nan("");
    Simulation simulation(cell, test::table_1(), state);
    EXPECT_NE(failure_of(simulation, 1024).quantity.find("moving wall"), std::string::npos);
  }
}

TEST(Simulation, StopsGrainsSlowerThanAnyPositionCanTell) {
  const Cell cell = test::open_cell();
  Scene scene = test::only_contacts();
  State state = test::at_rest({{10, 20, 20}, {20, 20, 20}, {30, 20, 20}}, cell);
  state.velocity.col(0) << 1e-310, -1e-320, 0;
  state.velocity.col(1) << 1e-305, -0x1p-1000, 1;
  state.velocity.col(2) << 0x1p-1001, -1, 1e-290;
  scene.time_step = 1e-9;
  Simulation simulation(cell, scene, state);
  simulation.advance(Drive{}, 1023);
  EXPECT_EQ(simulation.state().velocity, state.velocity);
  simulation.advance(Drive{}, 1);
  state.velocity.col(0).setZero();
  state.velocity(0, 1) = state.velocity(0, 2) = 0;
  EXPECT_EQ(simulation.state().velocity, state.velocity);
}

TEST(Simulation, RefusesStatesThatMakeNoSense) {
  const Cell cell = test::open_cell();
  State state = test::at_rest({{20, 20, 20}}, cell);
  state.velocity.resize(3, 2);
  EXPECT_THROW(Simulation(cell, test::table_1(), state), std::invalid_argument);
  EXPECT_THROW(Simulation(cell, test::table_1(), State{}), std::invalid_argument);
  const Cell shallow = test::open_cell(2.5);
  EXPECT_THROW(Simulation(shallow, test::table_1(), test::at_rest({{1, 1, 1}}, shallow)),
               std::invalid_argument);
}

}  // namespace
}  // namespace shearcell
