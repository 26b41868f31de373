// SPDX-License-Identifier: GPL-3.0-or-later
// What `plan` says a campaign will cost against what it then costs.
#include "experiments/runner/cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

PlannedRun only_run(const std::string& text) {
  return expand(parse_manifest(text, "t")).runs.at(0);
}

double bytes_of(const Store& store, const std::string& run) {
  double bytes = 0;
  for (const CheckpointRecord& record : store.checkpoints(run)) {
    bytes += static_cast<double>(record.size);
    EXPECT_EQ(record.size, std::filesystem::file_size(store.folder() / record.file));
  }
  return bytes;
}

TEST(Cost, CountsParticleSteps) {
  const PlannedRun run = only_run(tiny_manifest());
  EXPECT_EQ(stage_cost(run, run.last, 0).particle_steps, 2.0 * kGrains * kStepsPerCycle);
  EXPECT_EQ(stage_cost(run, run.last, 0.5).particle_steps, 1.5 * kGrains * kStepsPerCycle);
  EXPECT_EQ(stage_cost(run, run.last, 7).particle_steps, 0);
  EXPECT_EQ(stage_cost(run, run.last, 7).bytes, 0);
  EXPECT_GT(stage_cost(run, run.prepare, 0).particle_steps, 0);
}

TEST(Cost, CountsCheckpoints) {
  const PlannedRun run = only_run(tiny_manifest());
  const double both = stage_cost(run, run.last, 0).bytes;  // cycles 0, 1, 2
  const double file = both - stage_cost(run, run.last, 1).bytes * 2;
  EXPECT_GT(file, 0);
  EXPECT_NEAR(stage_cost(run, run.last, 1).bytes, file, 1e-6 * file);
  const PlannedRun rare = only_run(tiny_manifest("", "checkpoints: {every_cycles: 2}\n"));
  EXPECT_NEAR(stage_cost(rare, rare.last, 0).bytes, 2 * file, 1e-6 * file);
}

TEST(Cost, OfStiffeningIsThatOfTheSpringConstantsLeft) {
  const PlannedRun run = only_run(tiny_manifest("  protocol: stiffen\n"));
  const StageCost all = stage_cost(run, run.last, 0);
  EXPECT_GT(all.particle_steps, 0);
  EXPECT_NEAR(stage_cost(run, run.last, 6).particle_steps, all.particle_steps / 3, 1);
  EXPECT_NEAR(stage_cost(run, run.last, 6).bytes, all.bytes * 3 / 10, 1) << "cycles 0 to 9";
  EXPECT_EQ(stage_cost(run, run.last, 9).particle_steps, 0);
}

TEST(Cost, OfDiskAndSettlingAreNearWhatTheyTurnOutToBe) {
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  for (const char* texture : {"rough", "smooth"}) {
    const std::string text =
        tiny_manifest("  grains: 600\n  walls: " + std::string(texture) + "\n");
    compute(store, text);
    const PlannedRun run = only_run(text);
    for (const StageSpec* stage : {&run.prepare, &run.last}) {
      const StageCost expected = stage_cost(run, *stage, 0);
      const double bytes = bytes_of(store, stage->key);
      const double steps = store.run(stage->key).particle_steps;
      std::printf("%s %s: %.4g bytes, expected %.4g; %.4g particle-steps, expected %.4g\n", texture,
                  std::string(name_of(stage->stage)).c_str(), bytes, expected.bytes, steps,
                  expected.particle_steps);
      EXPECT_NEAR(expected.bytes / bytes, 1, 0.3);
      EXPECT_NEAR(expected.particle_steps / steps, 1, 0.4);
    }
  }
}

TEST(Cost, TakesTheRateFromTheStoreOnceItHasOne) {
  RunRecord run;
  run.particle_steps = 3e8;
  run.wall_seconds = 10;
  RunRecord other = run;
  other.particle_steps = 1e8;
  const Rate rate = expected_rate({run, other}, EngineKind::shearcell, 600);
  EXPECT_TRUE(rate.measured);
  EXPECT_EQ(rate.particle_steps_per_second, 2e7);
}

TEST(Cost, AssumesRatesThatFallWithTheNumberOfGrains) {
  for (const EngineKind engine : {EngineKind::shearcell, EngineKind::lammps}) {
    double before = 1e9;
    for (const double grains : {5200.0, 2e4, 1e5}) {
      const Rate rate = expected_rate({}, engine, grains);
      EXPECT_FALSE(rate.measured);
      EXPECT_LT(rate.particle_steps_per_second, before);
      before = rate.particle_steps_per_second;
    }
    const auto at = [engine](double n) {
      return expected_rate({}, engine, n).particle_steps_per_second;
    };
    EXPECT_EQ(at(100), at(5200));
    EXPECT_EQ(at(1e7), at(1e8));
  }
  const auto lammps = [](double n) {
    return expected_rate({}, EngineKind::lammps, n).particle_steps_per_second;
  };
  EXPECT_EQ(lammps(5200), 7.6e6);
  EXPECT_NEAR(lammps(1e5), 3.0e6, 1);
  EXPECT_NEAR(lammps(std::sqrt(5200 * 1e5)), std::sqrt(7.6e6 * 3.0e6), 1) << "a power of N";
}

}  // namespace
}  // namespace shearcell
