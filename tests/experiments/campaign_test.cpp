// SPDX-License-Identifier: GPL-3.0-or-later
// A campaign computes every stage once, in any order and with any number of workers. Later requests
// add to what is stored.
#include "experiments/runner/campaign.hpp"

#include <gtest/gtest.h>

#include <set>

#include "experiments/manifest/identity.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using CampaignTest = StoreTest;

TEST_F(CampaignTest, DeclaresParentsFirstAndEachStageOnce) {
  const Manifest manifest = parse_manifest(tiny_manifest("", kBothFluids + "seeds: 2\n"), "t");
  const Plan plan = expand(manifest);
  const std::vector<StageJob> jobs = declare(store_, plan);
  ASSERT_EQ(plan.runs.size(), 4U);
  ASSERT_EQ(jobs.size(), 6U);  // two packings, two fluids each
  std::set<std::string> seen = {""};
  for (const StageJob& job : jobs) {
    EXPECT_TRUE(seen.contains(job.parent)) << job.name;
    EXPECT_TRUE(seen.insert(job.id).second) << job.name;
  }
  EXPECT_EQ(store_.stages().size(), 6U);
  EXPECT_EQ(stages_to_resume(store_, {}).size(), 6U);

  const Head head = store_.head();
  EXPECT_EQ(declare(store_, plan).size(), 6U);
  EXPECT_EQ(store_.head().hash, head.hash) << "declaring again recorded something";
}

TEST_F(CampaignTest, NamesPackingsByTheirDifferences) {
  const auto names = [](const std::vector<StageJob>& jobs) {
    std::set<std::string> found;
    for (const StageJob& job : jobs) found.insert(job.name);
    return found;
  };
  const std::vector<StageJob> jobs =
      declared(store_, tiny_manifest("", "sweep: {grid: {grains: [200, 300]}}\n"));
  const std::set<std::string> expected = {"tiny packing N=200 seed=1", "tiny packing N=300 seed=1",
                                          "tiny N=200 seed=1", "tiny N=300 seed=1"};
  EXPECT_EQ(names(jobs), expected);
  EXPECT_EQ(names(stages_to_resume(store_, {})), expected);
}

// Without gravity, pressure_at has no effect and is not named.
TEST_F(CampaignTest, NamesPackingsByKeysThatAllHaveFirst) {
  declared(store_, tiny_manifest("",
                                 "sweep: {grid: {gravity_m_per_s2: [0, 9.81], pressure_at: [top, "
                                 "moving_wall]}}\n"));
  const VariantNames names(store_);
  std::set<std::string> found;
  for (const Stage& packing : runs_of_kind(store_, "prepare")) {
    found.insert(names.of(packing, packing.memberships.front().place));
  }
  EXPECT_EQ(found, (std::set<std::string>{"packing g=0 m/s^2",
                                          "packing g=9.81 m/s^2, pressure_at=moving_wall",
                                          "packing g=9.81 m/s^2, pressure_at=top"}));
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
  for (const Stage& run : sheared) {
    EXPECT_EQ(run.parent, packings[0].id);
    EXPECT_EQ(run.state, StageState::completed);
    EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(run.particle_steps, static_cast<double>(kGrains * 2 * kStepsPerCycle));
  }
  // Cycle 0 is the same packing for both; afterwards they differ.
  const Checkpoint settled = store_.load_checkpoint(store_.checkpoints(packings[0].id).back());
  for (const Stage& run : sheared) {
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
  EXPECT_TRUE(stages_to_resume(store_, {}).empty());
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
  compute(store_, tiny_manifest(), {.cycles = 1});
  const CampaignResult result = compute(store_, tiny_manifest(), {.cycles = 3});
  EXPECT_EQ(result.completed, 1U);
  EXPECT_EQ(result.already, 1U);
  const Stage run = sheared(store_);
  EXPECT_EQ(run.cycle, 3);
  EXPECT_EQ(run.attempts, 2U);
  EXPECT_EQ(run.particle_steps, static_cast<double>(kGrains * 3 * kStepsPerCycle));
  EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 1, 2, 3}));

  EXPECT_EQ(final_hashes(store_), undisturbed(tiny_manifest(), {.cycles = 3}));

  // A shorter target asks for nothing.
  EXPECT_EQ(compute(store_, tiny_manifest(), {.cycles = 2}).already, 2U);
}

TEST_F(CampaignTest, ResumesARequestedRunWithItsPacking) {
  const std::vector<StageJob> all = declared(store_, tiny_manifest("", "seeds: 2\n"));
  ASSERT_EQ(all.size(), 4U);
  const StageJob& wanted = all[3];
  const std::vector<StageJob> jobs = stages_to_resume(store_, {wanted.id.substr(0, 12)});
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].id, wanted.parent);
  EXPECT_EQ(jobs[1].id, wanted.id);
  EXPECT_EQ(run_campaign(store_, jobs, 1, {}, true).completed, 2U);
  EXPECT_EQ(store_.stage(wanted.id).state, StageState::completed);
  EXPECT_EQ(store_.stage(all[1].id).state, StageState::declared);

  EXPECT_THROW(stages_to_resume(store_, {"no digest"}), NotFound);
  EXPECT_THROW(stages_to_resume(store_, {""}), NotFound) << "an empty prefix fits every run";
}

TEST_F(CampaignTest, ARecordThatCannotBeReadStopsOnlyItsRun) {
  declared(store_, tiny_manifest());
  Stage run = sheared(store_);
  run.resolved["parameters"]["of_a_newer_version"] = 1;
  run.id = stage_key(run.resolved);
  store_.declare_stage(run);
  const CampaignResult result = resume(store_);
  EXPECT_EQ(result.completed, 2U);
  EXPECT_EQ(result.blocked, 1U);
  EXPECT_TRUE(has(result.messages.at(0), "of_a_newer_version"));
}

TEST_F(CampaignTest, ZeroCyclesGiveThePackingAlone) {
  compute(store_, tiny_manifest(), {.cycles = 0});
  const Stage run = sheared(store_);
  EXPECT_EQ(run.state, StageState::completed);
  EXPECT_EQ(cycles_of(store_, run.id), std::vector<double>{0});
  EXPECT_EQ(run.particle_steps, 0);
}

// Equal texts by another name: what two experiments share is computed once.
TEST_F(CampaignTest, ARunInTwoExperimentsRunsOnce) {
  compute(store_, tiny_manifest());
  const CampaignResult result = compute(store_, renamed(tiny_manifest("", kBothFluids), "twin"));
  EXPECT_EQ(result.already, 2U);
  EXPECT_EQ(result.completed, 1U);
  std::size_t shared = 0;
  for (const Stage& run : store_.stages()) shared += run.memberships.size() == 2 ? 1 : 0;
  EXPECT_EQ(shared, 2U);
}

// The checkpoints in between are those that a run of the denser cadence would have made.
TEST_F(CampaignTest, ADenserCadenceAddsTheCheckpointsInBetween) {
  const std::string text = tiny_manifest("  cycles: 6\n");
  compute(store_, text + "checkpoints: {every_cycles: 3}\n");
  const std::string run = sheared(store_).id;
  EXPECT_EQ(cycles_of(store_, run), (std::vector<double>{0, 3, 6}));
  const Stage before = store_.stage(run);
  EXPECT_EQ(compute(store_, text).completed, 1U);
  EXPECT_EQ(cycles_of(store_, run), (std::vector<double>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(store_.stage(run).state, StageState::completed);
  EXPECT_EQ(store_.stage(run).state_hash, before.state_hash);
  EXPECT_EQ(compute(store_, text).completed, 0U) << "nothing is left to do";
  EXPECT_TRUE(store_.verify().ok());

  Store dense(folder_.path() / "dense", Access::create);
  compute(dense, text);
  const auto filled = store_.checkpoints(run), direct = dense.checkpoints(run);
  ASSERT_EQ(filled.size(), direct.size());
  for (std::size_t k = 0; k < filled.size(); ++k) EXPECT_EQ(filled[k].sha256, direct[k].sha256);

  // Both cadences of two experiments that share the run, none of which contains the other.
  Store both(folder_.path() / "both", Access::create);
  declared(both, text + "checkpoints: {every_cycles: 2}\n");
  compute(both, "# three\n" + text + "checkpoints: {every_cycles: 3}\n");
  EXPECT_TRUE(look_at(both, both.stage(run)).missing.empty());
}

// An experiment whose last cycle is not a multiple of its cadence has a checkpoint there, whichever
// of the experiments that share the run comes first.
TEST_F(CampaignTest, EachExperimentHasACheckpointAtItsLastCycle) {
  const std::string every = "checkpoints: {every_cycles: 2}\n";
  const std::string brief = tiny_manifest("  cycles: 3\n") + every;
  const std::string full = "# full\n" + tiny_manifest("  cycles: 6\n") + every;
  const std::vector<double> cycles = {0, 2, 3, 4, 6};
  Store together(folder_.path() / "together", Access::create);
  declared(together, brief);
  compute(together, full);
  const std::string run = sheared(together).id;
  EXPECT_EQ(cycles_of(together, run), cycles);

  Store later(folder_.path() / "later", Access::create);
  compute(later, full);
  EXPECT_EQ(cycles_of(later, run), (std::vector<double>{0, 2, 4, 6}));
  EXPECT_EQ(compute(later, brief).completed, 1U);
  EXPECT_EQ(cycles_of(later, run), cycles);
  EXPECT_EQ(compute(later, brief).completed, 0U) << "nothing is left to do";
}

// Stores that computed parts of one campaign, merged, are the store that computed all of it.
TEST_F(CampaignTest, MergedFromThreeMachinesIsCompleteAndContinues) {
  const std::string text = tiny_manifest("", kBothFluids);
  const auto store_at = [&](const char* name) { return folder_.path() / name; };
  ExpandOptions two_seeds{.seeds = 2};
  {
    Store a(store_at("a"), Access::create), b(store_at("b"), Access::create),
        c(store_at("c"), Access::create), whole(store_at("whole"), Access::create);
    compute(a, text);                // one seed, both fluids
    compute(b, tiny_manifest());     // the same packing, one fluid: shared
    compute(c, text, two_seeds, 1);  // both seeds
    compute(whole, text);
    compute(whole, tiny_manifest());
    compute(whole, text, two_seeds);
  }
  Store merged(store_at("merged"), Access::create);
  const auto reports = merged.merge({store_at("a"), store_at("b"), store_at("c")});
  EXPECT_EQ(reports[1].checkpoints, 0U) << "the second one computed what the first had";
  const Store whole(store_at("whole"), Access::read);
  EXPECT_EQ(final_hashes(merged), final_hashes(whole));
  for (const Stage& run : whole.stages()) {
    const Stage other = merged.stage(run.id);
    EXPECT_EQ(other.state, run.state);
    EXPECT_EQ(other.attempts, run.attempts);
    EXPECT_EQ(other.memberships.size(), run.memberships.size());
    EXPECT_EQ(other.particle_steps, run.particle_steps) << "an effort was counted twice";
    EXPECT_EQ(cycles_of(merged, run.id), cycles_of(whole, run.id));
  }
  EXPECT_TRUE(merged.verify().ok());
  // Nothing is computed again, and more can be added.
  EXPECT_EQ(compute(merged, text, two_seeds).completed, 0U);
  two_seeds.cycles = 3;
  EXPECT_EQ(compute(merged, text, two_seeds).completed, 4U);
}

}  // namespace
}  // namespace shearcell::test
