// SPDX-License-Identifier: GPL-3.0-or-later
// A run that fails or has damaged files is named, keeps its good checkpoints, and stops no other
// run.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "experiments/runner/audit.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

class Failure : public StoreTest {
 protected:
  std::filesystem::path file_of(const CheckpointRecord& record) const {
    return store_.folder() / record.file;
  }
};

// A time in which no packing settles.
TEST_F(Failure, OfAPackingStopsOnlyItsShear) {
  const std::string text =
      tiny_manifest("", "sweep: {grid: {settle_time_limit_s: [60, 0.1], fluid: [still, cell]}}\n");
  const CampaignResult result = compute(store_, text);
  EXPECT_EQ(result.completed, 3U);
  EXPECT_EQ(result.failed, 1U);
  EXPECT_EQ(result.blocked, 2U);
  ASSERT_EQ(result.messages.size(), 1U);
  std::printf("%s\n", result.messages[0].c_str());
  EXPECT_TRUE(has(result.messages[0], "settle_time_limit_s"));

  for (const Stage& run : store_.stages()) {
    const bool sound = run.resolved.at("parameters").at("settle_time_limit_s") == 60;
    if (sound) {
      EXPECT_EQ(run.state, StageState::completed);
      continue;
    }
    if (run.kind == "shear") {
      EXPECT_EQ(run.state, StageState::declared) << "its packing failed, and yet it was begun";
      EXPECT_EQ(run.attempts, 0U);
      continue;
    }
    EXPECT_EQ(run.state, StageState::failed);
    EXPECT_TRUE(has(run.error, "settle"));
    const Event last = store_.events("run/" + run.id).back();
    ASSERT_EQ(last.type, "RunFailed");
    const nlohmann::json numbers = last.body().at("numbers");
    EXPECT_EQ(numbers.at("limit"), 0.1);
    EXPECT_GE(numbers.at("value").get<double>(), 0.1);
    EXPECT_GT(numbers.at("step").get<std::uint64_t>(), 0U);
  }
  EXPECT_EQ(std::ranges::count_if(store_.stages(),
                                  [&](const Stage& one) {
                                    return one.state != StageState::failed &&
                                           has_failed(store_, one);
                                  }),
            2)
      << "the two shears cannot start";
  // A second attempt fails in the same way.
  EXPECT_EQ(resume(store_).failed, 1U);
}

TEST_F(Failure, AtTheOverlapLimitIsResolvedByALargerLimit) {
  const CampaignResult low = compute(store_, tiny_manifest("  max_overlap_diameters: 0.001\n"));
  EXPECT_EQ(low.failed, 1U);
  const std::size_t runs = store_.stages().size();
  const CampaignResult usual = compute(store_, tiny_manifest(""));
  EXPECT_EQ(usual.failed, 0U);
  EXPECT_EQ(store_.stages().size(), runs) << "the same runs";
}

TEST_F(Failure, UnderShearKeepsTheLastGoodCheckpoint) {
  // Twenty cycles a second that tilt the walls by half a radian throw the grains about.
  constexpr double kLimit = 0.05;
  const CampaignResult result =
      compute(store_, tiny_manifest("  max_overlap_diameters: 0.05\n"
                                    "  period_s: 0.05\n"
                                    "  steps_per_cycle: 500\n"
                                    "  cycles: 6\n",
                                    "sweep: {grid: {amplitude_rad: [0.001, 0.5]}}\n"));
  for (const std::string& message : result.messages) std::printf("%s\n", message.c_str());
  EXPECT_EQ(result.completed, 2U);
  ASSERT_EQ(result.failed, 1U);
  for (const Stage& run : runs_of_kind(store_, "shear")) {
    if (run.state == StageState::completed) continue;
    ASSERT_EQ(run.state, StageState::failed);
    const auto kept = store_.checkpoints(run.id);
    ASSERT_FALSE(kept.empty());
    for (const CheckpointRecord& record : kept) {
      std::printf("cycle %g: largest overlap %.4f d, limit %g d\n", record.cycle,
                  record.observables.at("largest_overlap_d"), kLimit);
      EXPECT_LE(record.observables.at("largest_overlap_d"), kLimit) << "recorded as good";
    }
    const std::uint64_t failed_at =
        store_.events("run/" + run.id).back().body().at("numbers").at("step");
    EXPECT_LE(kept.back().step, failed_at);
    EXPECT_EQ(store_.load_checkpoint(kept.back()).state.step, kept.back().step);
    EXPECT_EQ(run.state_hash, kept.back().state_hash);
  }
  EXPECT_TRUE(store_.verify().ok());
}

// A run shorter than the watchdog's interval is not unwatched.
TEST_F(Failure, IsDetectedInAShortRun) {
  const CampaignResult result = compute(store_, tiny_manifest("  max_overlap_diameters: 0.05\n"
                                                              "  period_s: 0.05\n"
                                                              "  steps_per_cycle: 500\n"
                                                              "  amplitude_rad: 0.5\n"
                                                              "  cycles: 1\n"));
  EXPECT_EQ(result.failed, 1U);
  EXPECT_EQ(sheared(store_).state, StageState::failed);
}

TEST_F(Failure, OfTheNewestCheckpointIsRepairedFromThePreviousOne) {
  compute(store_, tiny_manifest("", kBothFluids));
  const auto expected = final_hashes(store_);
  const Stage run = sheared(store_);
  const CheckpointRecord newest = store_.checkpoints(run.id).back();
  truncate_file(file_of(newest));
  EXPECT_FALSE(store_.verify().ok());

  const CampaignResult result = compute(store_, tiny_manifest("", kBothFluids));
  EXPECT_EQ(result.damaged, 1U);
  EXPECT_EQ(result.completed, 1U);
  EXPECT_EQ(result.already, 2U);
  ASSERT_EQ(result.messages.size(), 1U);
  EXPECT_TRUE(has(result.messages[0], newest.file));
  EXPECT_EQ(final_hashes(store_), expected);
  EXPECT_EQ(count_events(store_, "CheckpointRejected", "run/" + run.id), 1U);
  EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 1, 2}));
  EXPECT_TRUE(store_.verify().ok());
  // One cycle was computed twice.
  EXPECT_EQ(store_.stage(run.id).particle_steps, static_cast<double>(kGrains * 3 * kStepsPerCycle));
}

TEST_F(Failure, OfTheLastStateLeavesWork) {
  compute(store_, tiny_manifest());
  const Stage run = sheared(store_);
  const auto records = store_.checkpoints(run.id);
  ASSERT_EQ(records.size(), 3U);
  EXPECT_TRUE(is_done(store_, run));
  truncate_file(file_of(records[1]));
  EXPECT_TRUE(is_done(store_, run)) << "no run continues from an older checkpoint";
  truncate_file(file_of(records[2]));
  EXPECT_FALSE(is_done(store_, run));

  Stage begun = run;
  begun.state = StageState::interrupted;
  EXPECT_FALSE(is_done(store_, begun));
}

// Half done, so the run is not completed: the damage must be named all the same.
TEST_F(Failure, OfTheNewestCheckpointOfAnUnfinishedRunIsNamed) {
  compute(store_, tiny_manifest());
  const Stage run = sheared(store_);
  const CheckpointRecord newest = store_.checkpoints(run.id).back();
  truncate_file(file_of(newest));
  const CampaignResult result = compute(store_, tiny_manifest(), {.cycles = 3});
  EXPECT_EQ(result.completed, 1U);
  EXPECT_EQ(result.damaged, 1U);
  ASSERT_EQ(result.messages.size(), 1U);
  EXPECT_TRUE(has(result.messages[0], newest.file));
  EXPECT_EQ(final_hashes(store_), undisturbed(tiny_manifest(), {.cycles = 3}));
}

TEST_F(Failure, OfEveryCheckpointRestartsFromThePacking) {
  compute(store_, tiny_manifest());
  const auto expected = final_hashes(store_);
  const Stage run = sheared(store_);
  for (const CheckpointRecord& record : store_.checkpoints(run.id)) truncate_file(file_of(record));
  EXPECT_EQ(compute(store_, tiny_manifest()).completed, 1U);
  EXPECT_EQ(final_hashes(store_), expected);
  EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 1, 2}));
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(Failure, OfAPackingFileIsRepairedToTheSameState) {
  const std::vector<StageJob> jobs = declared(store_, tiny_manifest());
  ASSERT_EQ(run_stage(store_, jobs[0].id, {}), StageOutcome::completed);
  for (const CheckpointRecord& record : store_.checkpoints(jobs[0].id)) {
    std::filesystem::remove(file_of(record));
  }
  const CampaignResult result = run_campaign(store_, jobs, 2, {}, true);
  EXPECT_EQ(result.damaged, 1U);
  EXPECT_EQ(result.completed, 2U);
  EXPECT_EQ(final_hashes(store_), undisturbed(tiny_manifest()));
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(Failure, OfThePackingFileIsDetectedByResume) {
  const std::vector<StageJob> jobs = declared(store_, tiny_manifest());
  ASSERT_EQ(run_stage(store_, jobs[0].id, {}), StageOutcome::completed);
  for (const CheckpointRecord& record : store_.checkpoints(jobs[0].id)) {
    truncate_file(file_of(record));
  }
  // The first resume meets the damage and names it; no later than the second mends it.
  const CampaignResult first = resume(store_);
  EXPECT_GE(first.damaged, 1U);
  ASSERT_FALSE(first.messages.empty());
  resume(store_);
  for (const Stage& run : store_.stages()) EXPECT_EQ(run.state, StageState::completed);
}

// A packing that was sound when the campaign looked at it.
TEST_F(Failure, OfThePackingFileDoesNotStartARunFromAnUnsettledState) {
  const std::vector<StageJob> jobs = declared(store_, tiny_manifest());
  interrupt_to_the_end(store_, jobs[0].id);
  const auto settling = store_.checkpoints(jobs[0].id);
  ASSERT_GT(settling.size(), 1U);
  truncate_file(file_of(settling.back()));
  EXPECT_THROW(run_stage(store_, jobs[1].id, {}), StoreDamaged);
  EXPECT_THROW(run_stage(store_, jobs[1].id, {}), StoreDamaged) << "the damage is known now";
  EXPECT_EQ(store_.stage(jobs[1].id).attempts, 0U);
  EXPECT_EQ(resume(store_).completed, 2U);
  EXPECT_TRUE(store_.verify().ok());
  EXPECT_TRUE(check_runs(store_).empty());
  EXPECT_EQ(final_hashes(store_), undisturbed(tiny_manifest()));
}

TEST_F(Failure, OfARunThatStartedFromAnUnsettledStateIsNamed) {
  const std::vector<StageJob> jobs = declared(store_, tiny_manifest());
  interrupt_to_the_end(store_, jobs[0].id);
  const CheckpointRecord unsettled = store_.checkpoints(jobs[0].id).front();
  store_.start_stage(jobs[1].id, {}, std::nullopt, unsettled.sha256);
  store_.interrupt_stage(jobs[1].id, "a test");
  const std::vector<Finding> findings = check_runs(store_);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Finding::Severity::error);
  EXPECT_EQ(findings[0].run, jobs[1].id);
  EXPECT_TRUE(has(findings[0].message, unsettled.sha256.substr(0, 12)));
}

}  // namespace
}  // namespace shearcell::test
