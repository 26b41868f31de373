// SPDX-License-Identifier: GPL-3.0-or-later
// A settled packing is in mechanical equilibrium, and interruptions do not change its bits.
#include "protocols/settle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/protocols/packings.hpp"
#include "tests/support/text.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

constexpr std::uint64_t kLookSteps = 2280;  // 0.1 s at Table I's time step

// N = 600, Table I, rough walls.
const Packing& settled_packing() {
  static const Packing packing = [] {
    Packing made = loose(rough_geometry(600), table_1());
    settle(made);
    return made;
  }();
  return packing;
}

// Sum of contact forces and weight on every grain that is held, by at least four contacts.
TEST(SettledPacking, IsAtRestGrainByGrain) {
  const Packing& packing = settled_packing();
  const double gravity = packing.scene.gravity, pressure = packing.scene.pressure;
  const double kinetic = 0.5 * packing.state.velocity.squaredNorm() / 600;
  const ContactForces f = forces(packing);
  double worst = 0;
  int held = 0;
  for (Eigen::Index i = 0; i < 600; ++i) {
    if (f.contacts[static_cast<std::size_t>(i)] < 4) continue;
    ++held;
    worst = std::max(worst, (f.on_grain.col(i) - gravity * Eigen::Vector3d::UnitY()).norm());
  }
  std::printf("held grains %d of 600, mean contact force %.4g, weight %.4g, worst residual %.3g\n",
              held, f.mean, gravity, worst);
  EXPECT_GT(held, 540);
  EXPECT_LT(worst, 0.01 * f.mean);
  EXPECT_LT(worst, 0.2 * gravity);
  EXPECT_LT(kinetic, 1e-8 * pressure);
  // The wall's own drag counts too, so that a creeping wall does not count as one at rest.
  EXPECT_LT(std::fabs(packing.state.wall_velocity) * packing.scene.wall_drag, 1e-3 * pressure);
}

TEST(SettledPacking, IsAsDenseAndAsSoftAsSphereGlass) {
  const Packing& packing = settled_packing();
  const ContactForces f = forces(packing);
  const Diagnostics facts = diagnose(packing.cell, packing.scene, packing.state, upright(packing));
  std::printf("contacts per grain %.3f, mean overlap %.3e d, largest %.3e d\n", f.touches_per_grain,
              f.mean_overlap, facts.largest_overlap);
  EXPECT_GT(f.touches_per_grain, 5.5);
  EXPECT_LT(f.touches_per_grain, 6.6);
  EXPECT_GT(f.mean_overlap, 1.5e-3);
  EXPECT_LT(f.mean_overlap, 3.5e-3);
  // What a run records says the same.
  EXPECT_DOUBLE_EQ(facts.contacts_per_grain, f.touches_per_grain);
  EXPECT_NEAR(facts.mean_overlap, f.mean_overlap, 1e-12);
}

// Forces of the walls on the grains, over P A: the moving wall carries its load, the others the
// rest of the weight. With P at the top a moving bottom wall bears the weight too.
TEST(Settle, BalancesTheLoadOfTheMovingWallAndTheWeightWithTheOtherWalls) {
  const struct {
    const char* name;
    MovingWall moving;
    PressureAt at;
    double gravity;
  } cases[] = {
      {"bottom", MovingWall::bottom, PressureAt::moving_wall, table_1().gravity},
      {"bottom, no gravity", MovingWall::bottom, PressureAt::moving_wall, 0},
      {"bottom, P at the top", MovingWall::bottom, PressureAt::top, table_1().gravity},
      {"top", MovingWall::top, PressureAt::moving_wall, table_1().gravity},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    Scene scene = table_1();
    scene.gravity = c.gravity;
    scene.pressure_at = c.at;
    Packing packing = loose(rough_geometry(600, c.moving), scene);
    settle(packing);
    EXPECT_EQ(packing.pressed == 0, c.gravity == 0);
    const ContactForces f = forces(packing);
    const bool bottom = c.moving == MovingWall::bottom;
    const double weight = 600 * scene.gravity / load(packing);
    const double carried = c.at == PressureAt::top ? 1 + weight : 1;
    Eigen::Vector3d all = Eigen::Vector3d::Zero();
    for (const auto& [side, force] : f.of_wall) all += force / load(packing);
    const double moving =
        f.of_wall.at(bottom ? WallSide::bottom : WallSide::top).y() / load(packing);
    std::printf("%s: from %.3f to %.3f d, moving wall %.5f, weight %.4f, others %.5f of P A\n",
                c.name, packing.cell.top, packing.state.wall_height, moving, weight,
                all.y() - moving);
    EXPECT_NEAR(moving, bottom ? carried : -carried, 1e-3);
    EXPECT_NEAR(all.y(), weight, 2e-3);
    EXPECT_NEAR(all.x(), 0, 2e-3);
    EXPECT_GT(f.touches_per_grain, 5.5);
    const Diagnostics facts = diagnose(packing.cell, scene, packing.state, upright(packing));
    EXPECT_LT(std::fabs(facts.wall_imbalance), 1e-3);
    EXPECT_GT(std::fabs(packing.state.wall_height - (bottom ? 0 : packing.cell.top)),
              0.4 * packing.cell.top);
  }
}

TEST(Settle, GivesTheSameBitsWhenItIsInterrupted) {
  const Packing& whole = settled_packing();
  ASSERT_GT(whole.pressed, 3 * kLookSteps);
  ASSERT_GT(whole.state.step, whole.pressed + kLookSteps);

  Packing pieces = loose(rough_geometry(600), table_1());
  const Settle protocol({}, pieces.scene);
  int pressing = 0, falling = 0;
  for (bool finished = false; !finished;) {
    // A new simulation and a new protocol for every few pieces of odd length.
    Simulation simulation(pieces.cell, pieces.scene, pieces.state);
    for (int piece = 0; piece < 3 && !finished; ++piece) {
      finished = protocol.advance(simulation, 777).finished;
    }
    pieces.state = simulation.state();
    ++(pieces.state.step < whole.pressed ? pressing : falling);
  }
  std::printf("restarts while pressing %d, under gravity %d; %llu steps, pressed for %llu\n",
              pressing, falling, static_cast<unsigned long long>(whole.state.step),
              static_cast<unsigned long long>(whole.pressed));
  EXPECT_GE(pressing, 2);
  EXPECT_GE(falling, 2);
  EXPECT_TRUE(same_bits(pieces.state, whole.state));
}

TEST(Settle, DoesNothingToASettledState) {
  const Packing& packing = settled_packing();
  const Settle protocol({}, packing.scene);
  Simulation simulation(packing.cell, packing.scene, packing.state);
  const StageProgress progress = protocol.advance(simulation, kAtOnce);
  EXPECT_TRUE(progress.finished);
  EXPECT_TRUE(progress.checkpoint_due);
  EXPECT_EQ(progress.cycle, 0);
  EXPECT_TRUE(same_bits(simulation.state(), packing.state));
}

TEST(Settle, NamesTheExceededLimit) {
  Packing packing = loose(rough_geometry(300), table_1());
  SettleParameters parameters;
  parameters.time_limit = 0.25;
  const NumericalFailure failure = test::failure_of([&] { settle(packing, parameters); });
  EXPECT_TRUE(has(failure.what(), "settle_time_limit_s"));
  EXPECT_EQ(failure.limit, 0.25);
  EXPECT_GE(failure.value, 0.25);
  EXPECT_LE(failure.value, 0.35 + 1e-9);  // it checks every 0.1 s
  EXPECT_EQ(failure.grain, -1);

  // Interruptions do not change at which step.
  Packing pieces = loose(rough_geometry(300), table_1());
  const Settle protocol(parameters, pieces.scene);
  const NumericalFailure same = test::failure_of([&] {
    for (;;) {
      Simulation simulation(pieces.cell, pieces.scene, pieces.state);
      protocol.advance(simulation, 777);
      pieces.state = simulation.state();
    }
  });
  EXPECT_EQ(same.step, failure.step);
  EXPECT_EQ(same.value, failure.value);
}

// The moving wall pushes out what it has caught between the wall grains; see settle.hpp.
TEST(Settle, AllowsLargeOverlapsWhileTheWallMovesIn) {
  Packing packing = loose(rough_geometry(300), table_1());
  packing.state.position.col(1) = packing.state.position.col(0) + Eigen::Vector3d(0, 0, 0.75);
  const Settle protocol({}, table_1());
  Simulation early(packing.cell, table_1(), packing.state);
  EXPECT_NO_THROW(protocol.advance(early, 1));

  // A step before one that the watchdog checks.
  packing.state.step = protocol.steps_without_gravity(packing.cell, 300) / 1024 * 1024 + 2047;
  Simulation late(packing.cell, table_1(), packing.state);
  const NumericalFailure failure = test::failure_of([&] { protocol.advance(late, 1); });
  EXPECT_EQ(failure.limit, 0.1);
  EXPECT_NEAR(failure.value, 0.25, 0.05);
}

TEST(Settle, PressesUntilTheWallHasMovedIn) {
  const Packing packing = loose(rough_geometry(600), table_1());
  const auto pressed = [&](const Scene& scene, const SettleParameters& parameters = {}) {
    return Settle(parameters, scene).steps_without_gravity(packing.cell, 600);
  };
  const std::uint64_t usual = pressed(table_1());
  EXPECT_GT(usual, 0U);
  EXPECT_EQ(usual % kLookSteps, 0U);

  Scene scene = table_1();
  scene.gravity = 0;
  EXPECT_EQ(pressed(scene), 0U);
  scene = table_1();
  scene.pressure = 0;
  EXPECT_EQ(pressed(scene), 0U);
  scene = table_1();
  scene.pressure /= 10;
  EXPECT_GT(pressed(scene), usual);
  scene = table_1();
  scene.wall_drag *= 10;
  EXPECT_GT(pressed(scene), usual);
  SettleParameters hasty;
  hasty.time_limit = 0.3;
  EXPECT_LE(pressed(table_1(), hasty), 3 * kLookSteps);

  // By then the grains are dense and carry the load.
  scene = table_1();
  scene.gravity = 0;
  Simulation simulation(packing.cell, scene, packing.state);
  simulation.advance(Drive{}, usual);
  const State state = simulation.state();
  const Diagnostics facts =
      diagnose(packing.cell, scene, state, wall_pose(packing.cell, 0, state.wall_height));
  std::printf("pressed for %.2f s: %.3f contacts per grain, wall imbalance %.3g\n",
              static_cast<double>(usual) * scene.time_step, facts.contacts_per_grain,
              facts.wall_imbalance);
  EXPECT_GT(facts.contacts_per_grain, 5);
  EXPECT_LT(std::fabs(facts.wall_imbalance), 0.1);
}

}  // namespace
}  // namespace shearcell
