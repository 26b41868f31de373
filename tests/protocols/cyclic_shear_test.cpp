// SPDX-License-Identifier: GPL-3.0-or-later
// Cyclic shear stops at the stated steps, and its result does not depend on chunks, restarts or the
// constants of the servo.
#include "protocols/cyclic_shear.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "protocols/rest.hpp"
#include "tests/protocols/packings.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

const Drive kDrive{.amplitude = 0.02, .steps_per_cycle = 3000, .pause_steps = 0};

const Sheared& dense() {
  static const Sheared scene = pressed(300, 20000);
  return scene;
}

struct Stop {
  std::uint64_t step;
  StageProgress progress;
};

// Advances to the end; every return of the protocol.
std::vector<Stop> shear(Simulation& simulation, const Protocol& protocol,
                        std::uint64_t most_steps = kAtOnce) {
  std::vector<Stop> stops;
  do {
    const StageProgress progress = protocol.advance(simulation, most_steps);
    stops.push_back({simulation.step(), progress});
  } while (!stops.back().progress.finished);
  return stops;
}

State after(const Protocol& protocol, std::uint64_t most_steps = kAtOnce) {
  Simulation simulation(dense().cell, table_1(), dense().state);
  shear(simulation, protocol, most_steps);
  return simulation.state();
}

TEST(CyclicShear, StopsAtTheEndOfEveryCycleUpright) {
  const Protocol protocol = cyclic_shear(kDrive, 4, {{1}});
  EXPECT_EQ(protocol.last_step, 12000U);
  Simulation simulation(dense().cell, table_1(), dense().state);
  const std::vector<Stop> stops = shear(simulation, protocol);
  ASSERT_EQ(stops.size(), 4U);
  for (std::size_t n = 0; n < stops.size(); ++n) {
    EXPECT_EQ(stops[n].step, 3000 * (n + 1));
    EXPECT_EQ(stops[n].progress.cycle, static_cast<double>(n + 1));
    EXPECT_TRUE(stops[n].progress.checkpoint_due);
    EXPECT_EQ(stops[n].progress.finished, n == 3);
    EXPECT_EQ(tilt(protocol.drive, stops[n].step).theta, 0);
  }
  // In between the walls do tilt, by A at a quarter.
  EXPECT_EQ(tilt(protocol.drive, 750).theta, kDrive.amplitude);
  EXPECT_FALSE(same_bits(simulation.state(), dense().state));
}

TEST(CyclicShear, HasCheckpointsAtItsCadencesAndAtTheEnd) {
  const std::vector<double> phases = {0.1, 0.5};
  EXPECT_EQ(steps_at(phases, kDrive), (std::vector<std::uint64_t>{300, 1500}));
  EXPECT_EQ(steps_at(std::vector<double>{0, 1e-9, 0.5, 0.5, 1 - 1e-9, 1, 2}, kDrive),
            std::vector<std::uint64_t>{1500});
  const struct {
    Protocol protocol;
    std::vector<std::uint64_t> due;
  } cases[] = {
      {cyclic_shear(kDrive, 4, {{1}}), {3000, 6000, 9000, 12000}},
      {cyclic_shear(kDrive, 4, {{3}}), {9000, 12000}},
      {cyclic_shear(kDrive, 4, {{1}, {2, {300, 1500}}, {3, {1500, 1600}}}),
       {300, 1500, 1600, 3000, 6000, 6300, 7500, 9000, 10500, 10600, 12000}},
  };
  const State expected = after(cases[0].protocol);
  for (const auto& [protocol, promised] : cases) {
    Simulation simulation(dense().cell, table_1(), dense().state);
    std::vector<std::uint64_t> due;
    for (const Stop& stop : shear(simulation, protocol, 700)) {
      if (stop.progress.checkpoint_due) due.push_back(stop.step);
    }
    EXPECT_EQ(due, promised);
    EXPECT_TRUE(same_bits(simulation.state(), expected)) << "how often is no physics";
  }
}

TEST(CyclicShear, DoesNothingBeyondItsTarget) {
  Simulation simulation(dense().cell, table_1(), dense().state);
  shear(simulation, cyclic_shear(kDrive, 2, {{1}}));
  const State end = simulation.state();
  for (const std::uint64_t target : {2U, 1U, 0U}) {
    const StageProgress progress = cyclic_shear(kDrive, target, {{1}}).advance(simulation, 1000);
    EXPECT_TRUE(progress.finished);
    EXPECT_TRUE(progress.checkpoint_due);
    EXPECT_EQ(progress.cycle, 2);
  }
  EXPECT_TRUE(same_bits(simulation.state(), end));
}

TEST(CyclicShear, GivesTheSameBitsInAnyChunksAndWhenItIsExtended) {
  const Protocol protocol = cyclic_shear(kDrive, 3, {{1}});
  const State whole = after(protocol);
  EXPECT_EQ(whole.step, 9000U);
  for (const std::uint64_t chunk : {1U, 613U, 3001U}) {
    EXPECT_TRUE(same_bits(after(protocol, chunk), whole)) << chunk;
  }
  Simulation extended(dense().cell, table_1(), after(cyclic_shear(kDrive, 2, {{1}})));
  shear(extended, protocol);
  EXPECT_TRUE(same_bits(extended.state(), whole));
}

TEST(CyclicShear, RestsDuringAPause) {
  Drive paused = kDrive;
  paused.pause_steps = 1000;
  // With the moving wall free, a cycle with its pause is a cycle and then time without shear.
  paused.pause_walls = PauseWalls::moving;
  Simulation whole(dense().cell, table_1(), dense().state);
  const std::vector<Stop> stops = shear(whole, cyclic_shear(paused, 1, {{1}}), 1700);
  EXPECT_EQ(stops.back().step, 4000U);
  Simulation parts(dense().cell, table_1(), dense().state);
  shear(parts, cyclic_shear(kDrive, 1, {{1}}));
  parts.advance(Drive{}, 1000);
  EXPECT_TRUE(same_bits(whole.state(), parts.state()));
}

TEST(CyclicShear, HoldsTheMovingWallDuringAPause) {
  Drive paused = kDrive;
  paused.pause_steps = 1000;
  const State before = after(cyclic_shear(kDrive, 1, {{1}}));
  const State end = after(cyclic_shear(paused, 1, {{1}}));
  EXPECT_NE(before.wall_velocity, 0);
  EXPECT_EQ(end.wall_height, before.wall_height);
  EXPECT_EQ(end.wall_velocity, 0);
  // Rest of the same length, from the state without a pause.
  const State rest = rested(dense().cell, table_1(), before, 1000 * table_1().time_step);
  EXPECT_EQ(rest.position, end.position);
  EXPECT_EQ(rest.velocity, end.velocity);
  // The wall moves again in the next cycle.
  EXPECT_NE(after(cyclic_shear(paused, 2, {{1}})).wall_height, end.wall_height);
}

TEST(CyclicShear, HasCheckpointsAtTheEndsOfPauses) {
  Drive paused = kDrive;
  paused.pause_steps = 1000;
  const Protocol protocol = cyclic_shear(paused, 2, {{1}});
  EXPECT_EQ(protocol.last_step, 8000U);
  Simulation simulation(dense().cell, table_1(), dense().state);
  for (const Stop& stop : shear(simulation, protocol, 900)) {
    EXPECT_EQ(stop.progress.checkpoint_due, stop.step % 4000 == 0) << stop.step;
  }
}

struct Balance {
  double mean = 0, rms = 0;  // of (load - force of the contacts) / (P A_w), over a cycle
  double rise = 0;           // of the density, over the cycle
};

// A cycle of Table I with another mass and drag of the moving wall, which are choices of the model.
Balance balance_over_a_cycle(double wall_factor) {
  Scene scene = table_1();
  scene.wall_mass *= wall_factor;
  scene.wall_drag *= wall_factor;
  Packing packing = loose(rough_geometry(300), scene);
  settle(packing);
  packing.state.step = 0;
  const Drive drive{.amplitude = 0.0833, .steps_per_cycle = 45600};
  Simulation simulation(packing.cell, scene, packing.state);
  constexpr int samples = 912;
  Balance balance;
  for (int n = 0; n < samples; ++n) {
    simulation.advance(drive, 50);
    const State state = simulation.state();
    const WallPose pose = wall_pose(packing.cell, tilt(drive, state.step).theta, state.wall_height);
    const double off = diagnose(packing.cell, scene, state, pose).wall_imbalance;
    balance.mean += off / samples;
    balance.rms += off * off / samples;
  }
  balance.rms = std::sqrt(balance.rms);
  balance.rise = (simulation.state().wall_height - packing.state.wall_height) /
                 (packing.cell.top - packing.state.wall_height);
  return balance;
}

// A pressure off by a share e changes the overlaps, 2.5e-3 d, by that share and the density by 3 e
// 2.5e-3. That must be far less than what a cycle compacts.
TEST(Servo, KeepsThePressureWithAnyMassAndDrag) {
  for (const double factor : {1.0, 3.0, 1.0 / 3}) {
    const Balance b = balance_over_a_cycle(factor);
    std::printf(
        "wall mass and drag x %.2f: imbalance %.2g on average, rms %.2g; density rose by %.2g\n",
        factor, b.mean, b.rms, b.rise);
    EXPECT_LT(std::fabs(b.mean), 2e-3);
    EXPECT_LT(b.rms, 0.03);
    EXPECT_GT(b.rise, 1e-3);
    EXPECT_LT(3 * 2.5e-3 * std::fabs(b.mean), 0.02 * b.rise);
  }
}

}  // namespace
}  // namespace shearcell
