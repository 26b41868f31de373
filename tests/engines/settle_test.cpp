// SPDX-License-Identifier: GPL-3.0-or-later
// One loose filling settled by our engine and by LAMMPS: equal first steps, packings with equal
// statistics, and an error when the grains do not settle.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/bench/engines.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "tests/experiments/program.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using bench::settle_by;
using bench::Settling;

constexpr std::size_t kOurs = 0, kLammps = 1;

class LammpsSettling : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_program("lmp")) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  }

  static Parameters small() { return {.grains = 300}; }
};

TEST_F(LammpsSettling, FollowsOurFirstSteps) {
  const bench::Packing loose = bench::loose_packing(small(), 1);
  const LammpsTask task{.cell = loose.cell,
                        .scene = settle_scene(loose.parameters),
                        .drive = {},
                        .state = loose.state,
                        .end = 500,
                        .stride = 500};
  const State theirs = run_lammps(find_lammps(), task, 1).state;
  Simulation simulation(task.cell, task.scene, task.state);
  simulation.advance(Drive{}, task.end);
  const State ours = simulation.state();
  const double moved = (ours.position - loose.state.position).colwise().norm().maxCoeff();
  const double apart = (ours.position - theirs.position).colwise().norm().maxCoeff();
  std::printf("moved %.2g d, apart %.2g d\n", moved, apart);
  EXPECT_GT(moved, 0.1);
  EXPECT_GT(ours.wall_height, loose.state.wall_height + 0.1) << "the wall is on its way";
  EXPECT_LT(apart, 1e-9);
  EXPECT_LT(std::fabs(ours.wall_height - theirs.wall_height), 1e-9);
}

TEST_F(LammpsSettling, GivesASimilarPacking) {
  const bench::Packing loose = bench::loose_packing(small(), 1);
  const Settling ours = settle_by(kOurs, find_lammps(), loose, {});
  const Settling theirs = settle_by(kLammps, find_lammps(), loose, {});
  for (const Settling* s : {&ours, &theirs}) {
    std::printf(
        "%g steps, phi %.4f, contacts %.3f, overlap %.3e d, imbalance %.1e, height %.3f d\n",
        static_cast<double>(s->state.step), s->numbers.phi, s->numbers.contacts_per_grain,
        s->numbers.mean_overlap, s->numbers.imbalance, s->numbers.height);
    EXPECT_LE(s->numbers.imbalance, SettleParameters{}.force_tolerance);
    EXPECT_LT(s->state.velocity.norm(), 1);
    EXPECT_GT(s->million_particle_steps_per_second, 0);
    EXPECT_GT(s->bytes, 1e4);
  }
  const Settle protocol({}, settle_scene(loose.parameters));
  EXPECT_EQ(protocol.next_check(theirs.state.step - 1), theirs.state.step) << "ended at a look";
  EXPECT_GT(theirs.state.step, protocol.steps_without_gravity(loose.cell, 300)) << "gravity was on";
  EXPECT_GT((ours.state.position - theirs.state.position).colwise().norm().maxCoeff(), 1e-3);
  EXPECT_NEAR(ours.numbers.phi, theirs.numbers.phi, 0.02);
  EXPECT_NEAR(ours.numbers.contacts_per_grain, theirs.numbers.contacts_per_grain, 0.3);
  EXPECT_NEAR(ours.numbers.height, theirs.numbers.height, 0.3);
  EXPECT_NEAR(theirs.numbers.mean_overlap / ours.numbers.mean_overlap, 1, 0.3);
}

// Grains heavier than the pressure on them push the wall down for ever, where no rough side wall
// holds them.
TEST_F(LammpsSettling, StopsAtTheTimeLimitIfAWallNeverRests) {
  Parameters heavy = small();
  heavy.gravity_m_per_s2 *= 5;
  heavy.pressure_at = PressureAt::moving_wall;
  heavy.walls = WallTexture::smooth;
  const bench::Packing loose = bench::loose_packing(heavy, 1);
  const Settle endless({}, settle_scene(heavy));
  SettleParameters settle;
  const auto pressed = static_cast<double>(endless.steps_without_gravity(loose.cell, 300));
  settle.time_limit = pressed * heavy.settle_time_step_s + 0.35;
  const LammpsProgram program = find_lammps();
  const auto message = [&](const auto& settling) -> std::string {
    try {
      settling();
    } catch (const NumericalFailure& failure) {
      EXPECT_EQ(failure.limit, settle.time_limit);
      EXPECT_GE(failure.value, settle.time_limit);
      return failure.what();
    }
    ADD_FAILURE() << "it settled";
    return "";
  };
  const std::string ours = message([&] { settle_by(kOurs, program, loose, settle); });
  const std::string theirs = message([&] { settle_by(kLammps, program, loose, settle); });
  EXPECT_TRUE(has(ours, "takes to settle"));
  EXPECT_TRUE(has(theirs, "takes to settle"));
}

class SettleCommand : public ProgramTest {};

TEST_F(SettleCommand, ReportsBoth) {
  if (!find_program("lmp")) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  const auto facts = json({"bench", "engines", "--size", "200", "--no-gravity", "--steps", "10",
                           "--cycles", "0", "--settle", "--json"});
  ASSERT_EQ(facts["settlings"].size(), 2U);
  EXPECT_EQ(facts["settlings"][0]["engine"], "shearcell");
  EXPECT_EQ(facts["settlings"][1]["engine"], "LAMMPS");
  for (const auto& settling : facts["settlings"]) {
    for (const char* key : {"steps", "wall_seconds", "million_particle_steps_per_second", "bytes",
                            "contacts_per_grain", "mean_overlap_d"}) {
      EXPECT_GT(settling[key].get<double>(), 0) << key;
    }
    EXPECT_LE(settling["wall_force_imbalance"], 1e-3);
  }
}

TEST_F(SettleCommand, ReportsThatTheTimeLimitWasReached) {
  if (!find_program("lmp")) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  expect(3, {"bench", "engines", "--size", "200", "--settle", "--settle-time-limit", "0.2"},
         {"takes to settle"});
}

}  // namespace
}  // namespace shearcell::test
