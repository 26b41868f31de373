// SPDX-License-Identifier: GPL-3.0-or-later
// A run that goes wrong stops, and says where and why.
#include <gtest/gtest.h>

#include <cmath>
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
