// SPDX-License-Identifier: GPL-3.0-or-later
// One loose filling settled by our engine and by LAMMPS: equal first steps, packings with equal
// statistics, and an error when the grains do not settle; and one settled packing sheared by both.
// The tests print what they measure. For larger packings, more seeds and several processes set
// SHEARCELL_ENGINE_GRAINS, SHEARCELL_ENGINE_SEEDS and SHEARCELL_ENGINE_MPI.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "analysis/statistics.hpp"
#include "experiments/manifest/conversion.hpp"
#include "provenance/io/clock.hpp"
#include "tests/support/packing.hpp"
#include "tests/support/run_lammps.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

std::uint64_t set_in_environment(const char* name, std::uint64_t otherwise) {
  const char* set = std::getenv(name);
  return set != nullptr ? std::stoull(set) : otherwise;
}

struct Settling {
  const char* engine;
  State state;            ///< its step counts from the loose grains
  double seconds = 0;     ///< of the whole settling
  double rate = 0;        ///< million particle-steps/s; of LAMMPS: in its time loop alone
  std::size_t bytes = 0;  ///< ours: of the simulation; LAMMPS: of its largest process
  PackingNumbers numbers;
};

Settling settled_by_us(const Packing& loose, const SettleParameters& parameters) {
  const Stopwatch watch;
  Simulation simulation = bench::simulate(loose);
  settle(simulation, parameters, loose.scene);
  const double seconds = watch.seconds();
  const State state = simulation.state();
  const auto work = static_cast<double>(state.step) * static_cast<double>(simulation.grains());
  return {"shearcell",
          state,
          seconds,
          1e-6 * work / seconds,
          simulation.bytes(),
          numbers_of(loose.cell, loose.scene, state)};
}

// LAMMPS takes the steps between two checks of the protocol, which decides from the resulting state
// whether more are needed. The result's step counts the steps that LAMMPS took.
Settling settled_by_lammps(const Packing& loose, const SettleParameters& parameters) {
  const Stopwatch watch;
  const std::size_t ranks = set_in_environment("SHEARCELL_ENGINE_MPI", 1);
  const LammpsProgram program = find_lammps(ranks);
  const Settle protocol(parameters, loose.scene);
  LammpsResult settled{loose.state, 0, 0};
  for (;;) {
    // One step of our own, whose result is discarded: in it the protocol decides whether the
    // packing has settled and which forces act now. Then the watchdog checks the grains.
    Simulation check(loose.cell, loose.scene, settled.state);
    if (protocol.advance(check, 1).finished) break;
    check.check();
    const std::uint64_t end = protocol.next_check(settled.state.step);
    const LammpsTask task{.cell = loose.cell,
                          .scene = check.scene(),
                          .drive = {},
                          .state = std::move(settled.state),
                          .end = end,
                          .stride = end,
                          .check_every = lammps_check_steps(check.grains(), ranks)};
    LammpsResult part = run_lammps(program, task, ranks);
    settled.state = std::move(part.state);
    settled.loop_seconds += part.loop_seconds;
    settled.peak_bytes = std::max(settled.peak_bytes, part.peak_bytes);
  }
  const State& state = settled.state;
  const auto work = static_cast<double>(state.step) * static_cast<double>(state.position.cols());
  return {"LAMMPS",           state,
          watch.seconds(),    1e-6 * work / settled.loop_seconds,
          settled.peak_bytes, numbers_of(loose.cell, loose.scene, state)};
}

void print(const char* what, const std::vector<double>& ours, const std::vector<double>& theirs) {
  const RunStatistics a = over_runs(ours), b = over_runs(theirs);
  std::printf("%s: shearcell %.6g +- %.2g, LAMMPS %.6g +- %.2g, %zu seeds\n", what, *a.mean,
              a.standard_error.value_or(NAN), *b.mean, b.standard_error.value_or(NAN), a.runs);
}

class LammpsSettling : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_program("lmp")) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  }

  // Without gravity where the pressure could not lift the grains.
  static Parameters small() {
    Parameters parameters;
    parameters.grains = set_in_environment("SHEARCELL_ENGINE_GRAINS", 300);
    if (parameters.grains > 18200) parameters.gravity_m_per_s2 = 0;
    return parameters;
  }
};

TEST_F(LammpsSettling, FollowsOurFirstSteps) {
  const Packing loose = loose_packing(small(), 1);
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
  const double moved = farthest(ours, loose.state);
  const double apart = farthest(ours, theirs);
  std::printf("moved %.2g d, apart %.2g d\n", moved, apart);
  EXPECT_GT(moved, 0.1);
  EXPECT_GT(ours.wall_height, loose.state.wall_height + 0.1) << "the wall is on its way";
  EXPECT_LT(apart, 1e-9);
  EXPECT_LT(std::fabs(ours.wall_height - theirs.wall_height), 1e-9);
}

TEST_F(LammpsSettling, GivesSimilarPackings) {
  std::vector<double> phi[2], contacts[2], overlap[2];
  for (std::uint64_t seed = 1; seed <= set_in_environment("SHEARCELL_ENGINE_SEEDS", 1); ++seed) {
    const Packing loose = loose_packing(small(), seed);
    const Settling ours = settled_by_us(loose, {}), theirs = settled_by_lammps(loose, {});
    for (const Settling* s : {&ours, &theirs}) {
      std::printf(
          "%s: %.0f steps, %.0f s, %.3g million particle-steps/s, %.3g MB; phi %.4f, contacts "
          "%.3f, overlap %.3e d, imbalance %.1e, height %.3f d\n",
          s->engine, static_cast<double>(s->state.step), s->seconds, s->rate,
          1e-6 * static_cast<double>(s->bytes), s->numbers.phi, s->numbers.contacts_per_grain,
          s->numbers.mean_overlap_d, s->numbers.imbalance, s->numbers.height);
      EXPECT_LE(s->numbers.imbalance, SettleParameters{}.force_tolerance);
      EXPECT_LT(s->state.velocity.norm(), 1);
      EXPECT_GT(s->rate, 0);
      EXPECT_GT(s->bytes, 10'000U);
      phi[s == &theirs].push_back(s->numbers.phi);
      contacts[s == &theirs].push_back(s->numbers.contacts_per_grain);
      overlap[s == &theirs].push_back(s->numbers.mean_overlap_d);
    }
    const Settle protocol({}, settle_scene(loose.parameters));
    EXPECT_EQ(protocol.next_check(theirs.state.step - 1), theirs.state.step) << "ended at a look";
    if (loose.parameters.gravity_m_per_s2 > 0) {
      EXPECT_GT(theirs.state.step, protocol.steps_without_gravity(loose.cell, small().grains))
          << "gravity was on";
    }
    EXPECT_GT(farthest(ours.state, theirs.state), 1e-3);
    EXPECT_NEAR(ours.numbers.phi, theirs.numbers.phi, 0.02);
    EXPECT_NEAR(ours.numbers.contacts_per_grain, theirs.numbers.contacts_per_grain, 0.3);
    EXPECT_NEAR(ours.numbers.height, theirs.numbers.height, 0.3);
    EXPECT_NEAR(theirs.numbers.mean_overlap_d / ours.numbers.mean_overlap_d, 1, 0.3);
  }
  print("phi", phi[0], phi[1]);
  print("contacts per grain", contacts[0], contacts[1]);
  print("mean overlap [d]", overlap[0], overlap[1]);
}

// As far apart as our own engine goes when one number changes by a unit in its last place. LAMMPS
// rounds differently in every sum.
TEST_F(LammpsSettling, AndShearDiffersFromOursByRounding) {
  const Parameters parameters = small();
  const Packing packing = settled_packing(parameters, 1);
  LammpsTask task{.cell = packing.cell,
                  .scene = shear_scene(parameters),
                  .drive = drive(parameters),
                  .state = packing.state,
                  .end = 1000,
                  .stride = 1000,
                  .check_every = lammps_check_steps(parameters.grains, 1)};
  const auto ours = [&](const LammpsTask& of) -> LammpsResult {
    Simulation simulation(of.cell, of.scene, of.state);
    simulation.forces();  // the first lists, which the loop of LAMMPS does not build either
    const Stopwatch watch;
    simulation.advance(of.drive, of.end);
    return {simulation.state(), watch.seconds(), simulation.bytes()};
  };
  const std::size_t ranks = set_in_environment("SHEARCELL_ENGINE_MPI", 1);
  const LammpsProgram program = find_lammps(ranks);
  const auto expect_near = [&](const char* scene) {
    LammpsTask moved = task;
    moved.state.position(0, 0) = std::nextafter(moved.state.position(0, 0), 1e9);
    const LammpsResult us = ours(task), them = run_lammps(program, task, ranks);
    const double apart = farthest(us.state, them.state);
    const double rounding = farthest(us.state, ours(moved).state);
    const auto rate = [&](const LammpsResult& run) {
      return 1e-6 * static_cast<double>(task.end * parameters.grains) / run.loop_seconds;
    };
    std::printf(
        "%s: apart %.2g d, one rounding %.2g d; million particle-steps/s: ours %.3g (%.3g MB), "
        "LAMMPS %.3g (%.3g MB)\n",
        scene, apart, rounding, rate(us), 1e-6 * static_cast<double>(us.peak_bytes), rate(them),
        1e-6 * static_cast<double>(them.peak_bytes));
    EXPECT_GT(farthest(us.state, task.state), 1e-3) << scene;
    EXPECT_LT(apart, std::max(1e-9, 1e3 * rounding)) << scene;
    EXPECT_LT(std::fabs(us.state.wall_height - them.state.wall_height),
              std::max(1e-9, 1e3 * rounding))
        << scene;
  };
  expect_near("still fluid");
  task.scene.fluid = Fluid::cell;
  expect_near("moving fluid");
  task.scene.drag_rate = 0;
  expect_near("no drag");
}

// Grains heavier than the pressure on them push the wall down for ever, where no rough side wall
// holds them.
TEST_F(LammpsSettling, StopsAtTheTimeLimitIfAWallNeverRests) {
  Parameters heavy{.grains = 300};
  heavy.gravity_m_per_s2 *= 5;
  heavy.pressure_at = PressureAt::moving_wall;
  heavy.walls = WallTexture::smooth;
  const Packing loose = loose_packing(heavy, 1);
  const Settle endless({}, settle_scene(heavy));
  SettleParameters settle;
  const auto pressed = static_cast<double>(endless.steps_without_gravity(loose.cell, heavy.grains));
  settle.time_limit = pressed * heavy.settle_time_step_s + 0.35;
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
  const std::string ours = message([&] { settled_by_us(loose, settle); });
  const std::string theirs = message([&] { settled_by_lammps(loose, settle); });
  EXPECT_TRUE(has(ours, "takes to settle"));
  EXPECT_TRUE(has(theirs, "takes to settle"));
}

}  // namespace
}  // namespace shearcell::test
