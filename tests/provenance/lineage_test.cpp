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

/// Shears run 3: cycles 1 and 2 take `seconds` of wall-clock time and `core_seconds` each.
void shear_two_cycles(Store& store, const nlohmann::json& host, double seconds,
                      std::optional<double> core_seconds) {
  const std::string id = run_id(3);
  store.declare_stage(sample_run(3));
  const auto known = store.checkpoints(id);
  store.start_stage(id, host, known.empty() ? std::nullopt : std::optional(known.back().sha256));
  for (std::uint64_t cycle = 1; cycle <= 2; ++cycle) {
    const std::uint64_t step = (cycle + known.size()) * kCycle;
    store.record_checkpoint(id, sample_checkpoint(id, step), {seconds, 10, core_seconds});
  }
  store.interrupt_stage(id, "SIGTERM");
}

TEST_F(Lineage, ComputingTimeIsTheSumOverAllAttempts) {
  const std::string id = run_id(3);
  shear_two_cycles(store_, sample_host("aaaa"), 5, 2.5);
  EXPECT_EQ(computing_time(store_, id, 9).core_seconds, 5);
  EXPECT_EQ(computing_time(store_, id, 1).core_seconds, 2.5) << "up to cycle 1";
  EXPECT_EQ(computing_time(store_, id, 0.5).core_seconds, 0);
  nlohmann::json other = sample_host("bbbb");
  other["cpu"] = "Another CPU";
  shear_two_cycles(store_, other, 5, 1.5);
  const ComputingTime both = computing_time(store_, id, 4);
  EXPECT_EQ(both.core_seconds, 8);
  EXPECT_EQ(both.processors, (std::set<std::string>{"A CPU", "Another CPU"}));
  EXPECT_EQ(computing_time(store_, id, 2).processors, std::set<std::string>{"A CPU"});
}

// Logs of earlier versions have no processor time, and processes under mpirun do not report theirs.
TEST_F(Lineage, ComputingTimeWithoutProcessorTimeIsThatOfTheClock) {
  shear_two_cycles(store_, sample_host("aaaa"), 5, std::nullopt);
  EXPECT_FALSE(
      nlohmann::json::parse(store_.events("run/" + run_id(3), "CheckpointRecorded")[0].payload)
          .contains("core_seconds"))
      << "the payload of earlier versions";
  EXPECT_EQ(computing_time(store_, run_id(3), 9).core_seconds, 10);
  nlohmann::json mpi = sample_host("aaaa");
  mpi["engine"] = {{"name", "LAMMPS"}, {"processes", 4}};
  shear_two_cycles(store_, mpi, 5, std::nullopt);
  EXPECT_EQ(computing_time(store_, run_id(3), 9).core_seconds, 10 + 4 * 10);
}

// Two machines computed the same cycles; a checkpoint that both have counts once.
TEST_F(Lineage, ComputingTimeOfMergedStoresCountsEachCheckpointOnce) {
  shear_two_cycles(store_, sample_host("aaaa"), 5, 2.5);
  {
    Store other(folder_.path() / "other", Access::create);
    shear_two_cycles(other, sample_host("bbbb"), 5, 1);
    shear_two_cycles(other, sample_host("bbbb"), 5, 1);
  }
  store_.merge({folder_.path() / "other"});
  EXPECT_EQ(store_.checkpoints(run_id(3)).size(), 4U);
  EXPECT_EQ(computing_time(store_, run_id(3), 9).core_seconds, 2 * 2.5 + 2 * 1);
}

TEST_F(Lineage, ComputingTimeOfADamagedPayloadNamesTheEvent) {
  append_to_run(store_, history_.sheared, {"CheckpointRecorded", {{"cycle", "two"}}});
  const auto read = [&] { computing_time(store_, history_.sheared, 9); };
  EXPECT_TRUE(has(message_of<StoreDamaged>(read), "(CheckpointRecorded"))
      << message_of<StoreDamaged>(read);
}

TEST_F(Lineage, ARegeneratedCheckpointIsSoundAgain) {
  store_.restore_checkpoint(store_.find_checkpoint(history_.rejected).value(),
                            sample_checkpoint(history_.sheared, 45600));
  EXPECT_TRUE(run_lineage(store_, history_.sheared).back().find(history_.rejected)->kept());
}

TEST_F(Lineage, AStartMayNameItsFirstState) {
  const std::string packing = store_.checkpoints(history_.packing).at(0).sha256;
  append_to_run(store_, history_.sheared, events::encode(events::RunStarted{{5, {}, {}}, packing}));
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
