// SPDX-License-Identifier: GPL-3.0-or-later
// A run that is interrupted any number of times, at any step, ends in the same bits as an
// uninterrupted one.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "experiments/runner/stage.hpp"
#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using Interruption = StoreTest;

// With the wish to stop pending from the start of each attempt, it ends after a single chunk of
// steps.
TEST_F(Interruption, AfterEachChunkChangesNothing) {
  for (const StageJob& job : declared(store_, tiny_manifest())) {
    const std::size_t interrupted = interrupt_to_the_end(
        store_, job.id, [&] { EXPECT_EQ(store_.stage(job.id).state, StageState::interrupted); });
    const Stage run = store_.stage(job.id);
    std::printf("%s: interrupted %zu times\n", job.name.c_str(), interrupted);
    EXPECT_GE(interrupted, 3U);
    EXPECT_EQ(run.attempts, interrupted + 1);
    EXPECT_EQ(run.state, StageState::completed);
    EXPECT_EQ(run.particle_steps, static_cast<double>(kGrains * run.step)) << "a step was repeated";
    EXPECT_EQ(count_events(store_, "RunInterrupted", "run/" + job.id), interrupted);
    EXPECT_EQ(count_events(store_, "RunResumed", "run/" + job.id), interrupted);
  }
  EXPECT_EQ(final_hashes(store_), undisturbed(tiny_manifest()));
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(Interruption, BeforeTheFirstStageStartsNothing) {
  const std::string text = tiny_manifest("", kBothFluids);
  request_stop(true);
  const CampaignResult result = compute(store_, text);
  EXPECT_EQ(result.blocked, 3U);
  EXPECT_EQ(result.completed + result.interrupted, 0U);
  EXPECT_EQ(count_events(store_, "RunStarted"), 0U);
  request_stop(false);
  EXPECT_EQ(resume(store_).completed, 3U);

  request_stop(true);
  const CampaignResult again = compute(store_, text);
  EXPECT_EQ(again.already, 3U) << "they were done before";
  EXPECT_EQ(again.blocked, 0U);
  const CampaignResult phases =
      compute(store_, tiny_manifest("", kBothFluids + "checkpoints: {phases: [0.5]}\n"));
  EXPECT_EQ(phases.blocked, 2U) << "they are completed, but lack checkpoints";
}

// Two seconds without a record, at a lease of a quarter of it.
TEST_F(Interruption, ByAnotherProgramIsPreventedBetweenDistantCheckpoints) {
  const std::string text = tiny_manifest("  cycles: 40\n", "checkpoints: {every_cycles: 40}\n");
  Store runner(store_.folder(), Access::write, 0.5);
  std::atomic<bool> done = false;
  int refused = 0, taken = 0;
  std::thread other([&] {
    while (!done) {
      for (const Stage& run : runs_of_kind(store_, "shear")) {
        if (run.state != StageState::running) continue;
        try {
          store_.start_stage(run.id, {},
                             store_.checkpoints(run.id).empty()
                                 ? std::nullopt
                                 : std::optional(store_.checkpoints(run.id).back().sha256));
          ++taken;
        } catch (const ConcurrencyConflict& conflict) {
          // Or it was completed between the check and the call.
          if (has(conflict.what(), "another program is computing it")) ++refused;
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  const CampaignResult result = compute(runner, text, {}, 1);
  done = true;
  other.join();
  std::printf("refused %d times\n", refused);
  EXPECT_EQ(result.completed, 2U);
  EXPECT_EQ(taken, 0);
  EXPECT_GT(refused, 5);
}

// A run that is interrupted within a cycle continues at the declared cadence.
TEST_F(Interruption, KeepsTheCadenceOfItsCheckpoints) {
  const std::string text = tiny_manifest("", "checkpoints: {every_cycles: 2}\n");
  const std::vector<StageJob> jobs = declared(store_, text, {.cycles = 5});
  ASSERT_EQ(jobs.size(), 2U);
  run_stage(store_, jobs[0].id, {});
  ASSERT_EQ(run_one_chunk(store_, jobs[1].id), StageOutcome::interrupted);
  const double stopped_at = store_.stage(jobs[1].id).cycle;
  std::printf("stopped at cycle %g\n", stopped_at);
  ASSERT_GT(stopped_at, 0);
  ASSERT_LT(stopped_at, 1);
  const std::vector<StageJob> left = stages_to_resume(store_, {});
  ASSERT_EQ(left.size(), 2U) << "the packing before it, and the run";
  EXPECT_EQ(resume(store_).completed, 1U);
  EXPECT_EQ(cycles_of(store_, jobs[1].id), (std::vector<double>{0, stopped_at, 2, 4, 5}));
}

}  // namespace
}  // namespace shearcell::test
