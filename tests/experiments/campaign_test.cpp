// SPDX-License-Identifier: GPL-3.0-or-later
// A campaign computes every stage once, in any order and with any number of workers, and what is
// asked for later is added to what is there.
#include "experiments/runner/campaign.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "experiments/runner/run_end.hpp"
#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class CampaignTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
  Store store_{folder_.path() / "store", Access::create};
};

TEST_F(CampaignTest, DeclaresParentsFirstAndEachStageOnce) {
  const Manifest manifest = parse_manifest(tiny_manifest("", kBothFluids + "seeds: 2\n"), "t");
  const Plan plan = expand(manifest);
  const std::vector<StageJob> jobs = declare(store_, manifest, plan);
  ASSERT_EQ(plan.runs.size(), 4U);
  ASSERT_EQ(jobs.size(), 6U);  // two packings, two fluids each
  std::set<std::string> seen = {""};
  for (const StageJob& job : jobs) {
    EXPECT_TRUE(seen.contains(job.parent)) << job.name;
    EXPECT_TRUE(seen.insert(job.id).second) << job.name;
  }
  EXPECT_EQ(store_.runs().size(), 6U);
  EXPECT_EQ(unfinished(store_, {}).size(), 6U);

  const Head head = store_.head();
  EXPECT_EQ(declare(store_, manifest, plan).size(), 6U);
  EXPECT_EQ(store_.head().hash, head.hash) << "declaring again recorded something";
}

TEST_F(CampaignTest, ComputesEachPackingOnceForBothFluids) {
  const CampaignResult result = compute(store_, tiny_manifest("", kBothFluids));
  EXPECT_EQ(result.completed, 3U);
  EXPECT_EQ(result.already + result.failed + result.interrupted + result.blocked + result.damaged,
            0U);
  const auto packings = runs_of_kind(store_, "prepare");
  const auto sheared = runs_of_kind(store_, "shear");
  ASSERT_EQ(packings.size(), 1U);
  ASSERT_EQ(sheared.size(), 2U);
  EXPECT_EQ(packings[0].attempts, 1U);
  EXPECT_EQ(packings[0].particle_steps, static_cast<double>(kGrains * packings[0].step));
  for (const RunRecord& run : sheared) {
    EXPECT_EQ(run.parent, packings[0].id);
    EXPECT_EQ(run.state, RunState::completed);
    EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(run.particle_steps, static_cast<double>(kGrains * 2 * kStepsPerCycle));
  }
  // Cycle 0 is the same packing for both; afterwards they differ.
  const Checkpoint settled = store_.load_checkpoint(store_.checkpoints(packings[0].id).back());
  for (const RunRecord& run : sheared) {
    const Checkpoint first = store_.load_checkpoint(store_.checkpoints(run.id).front());
    EXPECT_EQ(first.state.position, settled.state.position);
    EXPECT_EQ(first.state.velocity, settled.state.velocity);
    EXPECT_EQ(first.state.step, 0U);
  }
  EXPECT_NE(sheared[0].state_hash, sheared[1].state_hash);

  const Head head = store_.head();
  const CampaignResult again = compute(store_, tiny_manifest("", kBothFluids));
  EXPECT_EQ(again.already, 3U);
  EXPECT_EQ(again.completed, 0U);
  EXPECT_EQ(store_.head().hash, head.hash) << "computing nothing recorded something";
  EXPECT_TRUE(unfinished(store_, {}).empty());
}

TEST_F(CampaignTest, GivesTheSameStatesWithAnyNumberOfWorkers) {
  const std::string manifest = tiny_manifest("", kBothFluids + "seeds: 2\n");
  compute(store_, manifest, {}, 1);
  const auto expected = final_hashes(store_);
  ASSERT_EQ(expected.size(), 6U);
  std::set<std::string> different;
  for (const auto& [id, hash] : expected) different.insert(hash);
  EXPECT_EQ(different.size(), 6U);
  for (const std::size_t workers : {2U, 4U}) {
    Store other(folder_.path() / ("store" + std::to_string(workers)), Access::create);
    EXPECT_EQ(compute(other, manifest, {}, workers).completed, 6U);
    EXPECT_EQ(final_hashes(other), expected) << workers << " workers";
  }
}

TEST_F(CampaignTest, ExtendsARunWithoutRepeatingAStep) {
  ExpandOptions options;
  options.cycles = 1;
  compute(store_, tiny_manifest(), options);
  ASSERT_EQ(runs_of_kind(store_, "shear").size(), 1U);
  options.cycles = 3;
  const CampaignResult result = compute(store_, tiny_manifest(), options);
  EXPECT_EQ(result.completed, 1U);
  EXPECT_EQ(result.already, 1U);
  const RunRecord run = runs_of_kind(store_, "shear").front();
  EXPECT_EQ(run.cycle, 3);
  EXPECT_EQ(run.attempts, 2U);
  EXPECT_EQ(run.particle_steps, static_cast<double>(kGrains * 3 * kStepsPerCycle));
  EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 1, 2, 3}));

  Store other(folder_.path() / "other", Access::create);
  compute(other, tiny_manifest(), options);
  EXPECT_EQ(final_hashes(other), final_hashes(store_));

  // A shorter target asks for nothing.
  options.cycles = 2;
  EXPECT_EQ(compute(store_, tiny_manifest(), options).already, 2U);
}

TEST_F(CampaignTest, MoreSeedsAddRunsAndLeaveTheOthers) {
  compute(store_, tiny_manifest());
  const auto before = final_hashes(store_);
  ExpandOptions options;
  options.seeds = 3;
  const CampaignResult result = compute(store_, tiny_manifest(), options);
  EXPECT_EQ(result.already, 2U);
  EXPECT_EQ(result.completed, 4U);
  const auto after = final_hashes(store_);
  EXPECT_EQ(after.size(), 6U);
  for (const auto& [id, hash] : before) EXPECT_EQ(after.at(id), hash);
}

TEST_F(CampaignTest, ResumesWhatIsAskedForWithItsPacking) {
  const Manifest manifest = parse_manifest(tiny_manifest("", "seeds: 2\n"), "t");
  const std::vector<StageJob> declared = declare(store_, manifest, expand(manifest));
  ASSERT_EQ(declared.size(), 4U);
  const StageJob& wanted = declared[3];
  const std::vector<StageJob> jobs = unfinished(store_, {wanted.id.substr(0, 12)});
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].id, wanted.parent);
  EXPECT_EQ(jobs[1].id, wanted.id);
  Progress progress(jobs.size(), true);
  EXPECT_EQ(run_campaign(store_, jobs, 1, progress).completed, 2U);
  EXPECT_EQ(store_.run(wanted.id).state, RunState::completed);
  EXPECT_EQ(store_.run(declared[1].id).state, RunState::declared);

  EXPECT_THROW(unfinished(store_, {"no digest"}), NotFound);
  EXPECT_THROW(unfinished(store_, {""}), NotFound) << "an empty prefix fits every run";
}

TEST_F(CampaignTest, RecordsAtTheCadenceThatWasAskedFor) {
  compute(store_, tiny_manifest("", "checkpoints: {every_cycles: 2}\n"),
          ExpandOptions{.scale = {}, .cycles = 5, .seeds = {}});
  const RunRecord run = runs_of_kind(store_, "shear").front();
  EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 2, 4, 5}));
}

TEST_F(CampaignTest, TakesZeroCyclesAsThePackingAlone) {
  compute(store_, tiny_manifest(), ExpandOptions{.scale = {}, .cycles = 0, .seeds = {}});
  const RunRecord run = runs_of_kind(store_, "shear").front();
  EXPECT_EQ(run.state, RunState::completed);
  EXPECT_EQ(cycles_of(store_, run.id), std::vector<double>{0});
  EXPECT_EQ(run.particle_steps, 0);
}

// Equal texts by another name: what two experiments share is computed once.
TEST_F(CampaignTest, ARunInTwoExperimentsRunsOnce) {
  compute(store_, tiny_manifest());
  std::string other = tiny_manifest("", kBothFluids);
  other.replace(other.find("tiny"), 4, "twin");
  const CampaignResult result = compute(store_, other);
  EXPECT_EQ(result.already, 2U);
  EXPECT_EQ(result.completed, 1U);
  std::size_t shared = 0;
  for (const RunRecord& run : store_.runs()) shared += run.memberships.size() == 2 ? 1 : 0;
  EXPECT_EQ(shared, 2U);
}

// The checkpoints in between are those that a run of the denser cadence would have made.
TEST_F(CampaignTest, ADenserCadenceAddsTheCheckpointsInBetween) {
  const std::string text = tiny_manifest("  cycles: 6\n");
  compute(store_, text + "checkpoints: {every_cycles: 3}\n");
  const std::string run = runs_of_kind(store_, "shear").front().id;
  EXPECT_EQ(cycles_of(store_, run), (std::vector<double>{0, 3, 6}));
  const RunRecord before = store_.run(run);
  EXPECT_EQ(compute(store_, text).completed, 1U);
  EXPECT_EQ(cycles_of(store_, run), (std::vector<double>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(store_.run(run).state, RunState::completed);
  EXPECT_EQ(store_.run(run).state_hash, before.state_hash);
  EXPECT_EQ(compute(store_, text).completed, 0U) << "nothing is left to do";
  EXPECT_TRUE(store_.verify().ok());

  Store dense(folder_.path() / "dense", Access::create);
  compute(dense, text);
  const auto filled = store_.checkpoints(run), direct = dense.checkpoints(run);
  ASSERT_EQ(filled.size(), direct.size());
  for (std::size_t k = 0; k < filled.size(); ++k) EXPECT_EQ(filled[k].sha256, direct[k].sha256);

  // Both cadences of two experiments that share the run, none of which contains the other.
  Store both(folder_.path() / "both", Access::create);
  const Manifest two = parse_manifest(text + "checkpoints: {every_cycles: 2}\n", "two.yaml");
  declare(both, two, expand(two));
  compute(both, "# three\n" + text + "checkpoints: {every_cycles: 3}\n");
  EXPECT_TRUE(missing_checkpoints(both, both.run(run)).empty());
}

}  // namespace
}  // namespace shearcell
