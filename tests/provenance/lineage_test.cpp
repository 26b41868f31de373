// SPDX-License-Identifier: GPL-3.0-or-later
// The log records for every checkpoint the attempt, build and state that it came from.
#include "provenance/lineage.hpp"

#include <gtest/gtest.h>

#include "tests/provenance/lineage_samples.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class Lineage : public testing::Test {
 protected:
  TemporaryFolder folder_;
  Store store_{folder_.path() / "store", Access::create};
  SampleHistory history_{store_};
};

TEST_F(Lineage, AttemptsAreListedFromTheirStartToTheirEnd) {
  const std::vector<RunLineage> stages = run_lineage(store_, history_.sheared);
  ASSERT_EQ(stages.size(), 2U);
  EXPECT_EQ(stages[0].stage.id, history_.packing);
  EXPECT_EQ(stages[1].stage.id, history_.sheared);
  const std::vector<Attempt>& attempts = stages[1].attempts;
  ASSERT_EQ(attempts.size(), 4U);
  EXPECT_EQ(attempts[0].outcome, AttemptOutcome::interrupted);
  EXPECT_EQ(attempts[0].why, "stopped by a signal");
  EXPECT_EQ(attempts[1].outcome, AttemptOutcome::lost);
  EXPECT_EQ(attempts[1].ended_at, "") << "nobody saw it end";
  EXPECT_EQ(attempts[2].outcome, AttemptOutcome::failed);
  EXPECT_EQ(attempts[3].outcome, AttemptOutcome::completed);
  for (const Attempt& attempt : attempts) {
    EXPECT_FALSE(attempt.started_at.empty());
    EXPECT_EQ(attempt.host["host"], "node7");
  }
  EXPECT_EQ(attempts[1].host["build"]["commit"], "aaaa");
  EXPECT_EQ(attempts[3].host["build"]["commit"], "bbbb");
  EXPECT_EQ(attempts[3].checkpoints.size(), 2U);
}

TEST_F(Lineage, TheFirstAttemptStartsFromThePackingAndLaterOnesFromTheirOwnState) {
  const std::vector<RunLineage> stages = run_lineage(store_, history_.sheared);
  const std::string packing = stages[0].checkpoints.at(0).record.sha256;
  const std::vector<Attempt>& attempts = stages[1].attempts;
  EXPECT_EQ(stages[0].attempts.at(0).from_checkpoint, "");
  EXPECT_EQ(attempts[0].from_run, history_.packing);
  EXPECT_EQ(attempts[0].from_checkpoint, packing);
  EXPECT_EQ(attempts[1].from_run, history_.sheared);
  EXPECT_EQ(attempts[1].from_checkpoint, attempts[0].checkpoints.at(0));
  EXPECT_EQ(attempts[3].from_checkpoint, attempts[0].checkpoints.at(0)) << "not the rejected one";
}

TEST_F(Lineage, ARejectedCheckpointIsMarkedUntilItIsRecomputed) {
  const auto rejected = [&] {
    const RunLineage run = run_lineage(store_, history_.sheared).back();
    return run.find(history_.rejected)->record.state == CheckpointState::rejected;
  };
  EXPECT_TRUE(rejected());
  Stage longer = sample_run(2, 9);
  const Stage known = store_.stage(history_.sheared);
  longer.parent = known.parent;
  longer.resolved = known.resolved;
  store_.declare_stage(longer);
  store_.start_stage(history_.sheared, {}, store_.checkpoints(history_.sheared).back().sha256);
  EXPECT_EQ(SampleHistory::record(store_, history_.sheared, 45600), history_.rejected);
  EXPECT_FALSE(rejected());
  const RunLineage run = run_lineage(store_, history_.sheared).back();
  EXPECT_EQ(run.find(history_.rejected)->attempt, 4U);
  EXPECT_EQ(run.attempts.back().outcome, AttemptOutcome::running);
  EXPECT_TRUE(run.attempts.back().host.empty()) << "none was recorded";
}

TEST_F(Lineage, ARegeneratedCheckpointIsSoundAgain) {
  store_.restore_checkpoint(store_.find_checkpoint(history_.rejected).value(),
                            sample_checkpoint(history_.sheared, 45600));
  EXPECT_TRUE(run_lineage(store_, history_.sheared).back().find(history_.rejected)->kept());
}

TEST_F(Lineage, AStartMayNameItsFirstState) {
  const std::string packing = store_.checkpoints(history_.packing).at(0).sha256;
  append_to_run(store_, history_.sheared, events::encode(events::RunStarted{5, {}, {}, packing}));
  const Attempt named = run_lineage(store_, history_.sheared).back().attempts.back();
  EXPECT_EQ(named.from_run, history_.packing);
  EXPECT_EQ(named.from_checkpoint, packing);
  // A payload that is not what it must be is damage and names its event.
  append_to_run(store_, history_.sheared, {"CheckpointRecorded", {{"sha256", "../../x"}}});
  expect_refused<StoreDamaged>([this] { run_lineage(store_, history_.sheared); },
                               {"event " + std::to_string(store_.head().seq)});
}

TEST_F(Lineage, TheManifestIsFoundByItsHash) {
  const auto manifest = find_manifest(store_, sha256_hex("manifest"));
  ASSERT_TRUE(manifest.has_value());
  EXPECT_EQ(manifest->text, "manifest");
  EXPECT_FALSE(find_manifest(store_, sha256_hex("another")).has_value());
  EXPECT_THROW(run_lineage(store_, run_id(99)), NotFound);
}

}  // namespace
}  // namespace shearcell
