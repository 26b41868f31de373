// SPDX-License-Identifier: GPL-3.0-or-later
// Pruning deletes files but no records, and nothing that is still needed.
#include <gtest/gtest.h>

#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class PruneTest : public ::testing::Test {
 protected:
  /// Run 0 with cycles 0 to 6 has completed; run 1, which began from cycle 3 of it, has failed.
  PruneTest() {
    for (int i = 0; i < 2; ++i) {
      Stage declaration = sample_run(i, 6);
      if (i == 1) declaration.parent = run_id(0);
      store_.declare_stage(declaration);
    }
    store_.start_stage(run_id(0), {});
    for (std::uint64_t c = 0; c <= 6; ++c) record(0, c);
    store_.complete_stage(run_id(0), {}, 6);
    store_.start_stage(run_id(1), {}, std::nullopt, records_[3].sha256);
    for (std::uint64_t c = 0; c <= 2; ++c) record(1, c);
    store_.fail_stage(run_id(1), "unstable");
  }

  void record(int run, std::uint64_t cycle) {
    records_.push_back(
        store_.record_checkpoint(run_id(run), sample_checkpoint(run_id(run), cycle * kCycle)));
  }

  static std::vector<double> cycles(const std::vector<CheckpointRecord>& records) {
    std::vector<double> found;
    for (const CheckpointRecord& record : records) found.push_back(record.cycle);
    return found;
  }

  bool there(const CheckpointRecord& record) const { return fs::exists(path_ / record.file); }

  TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "store";
  Store store_{path_, Access::create};
  std::vector<CheckpointRecord> records_;
};

TEST_F(PruneTest, ChoosesByCadenceAndRun) {
  const auto chosen = [this](const PruneChoice& choice) { return cycles(store_.prunable(choice)); };
  // Never the last of a run, nor cycle 3 of run 0, from which run 1 began.
  EXPECT_EQ(chosen({}), (std::vector<double>{0, 1, 2, 4, 5, 0, 1}));
  EXPECT_EQ(chosen({{}, 2}), (std::vector<double>{1, 5, 1}));
  EXPECT_EQ(chosen({{run_id(1)}, 0}), (std::vector<double>{0, 1}));
  EXPECT_EQ(store_.events().size(), 16u) << "choosing recorded something";
}

// They have no cycles, so a cadence keeps the first and the last.
TEST_F(PruneTest, ACadenceFreesCheckpointsOfSettling) {
  store_.declare_stage(sample_run(2, 6));
  store_.start_stage(run_id(2), {});
  for (std::uint64_t part = 0; part <= 3; ++part) {
    Checkpoint checkpoint = sample_checkpoint(run_id(2), part * kCycle);
    checkpoint.cycle = 0;
    store_.record_checkpoint(run_id(2), checkpoint);
  }
  std::vector<std::uint64_t> steps;
  for (const CheckpointRecord& record : store_.prunable({{run_id(2)}, 100})) {
    steps.push_back(record.step);
  }
  EXPECT_EQ(steps, (std::vector<std::uint64_t>{kCycle, 2 * kCycle}));
}

TEST_F(PruneTest, FreesTheFilesAndKeepsTheRecords) {
  const auto chosen = store_.prunable({{}, 3});
  ASSERT_EQ(cycles(chosen), (std::vector<double>{1, 2, 4, 5, 1}));
  std::uint64_t bytes = 0;
  for (const CheckpointRecord& record : chosen) bytes += record.size;
  const auto before = store_.stages();
  EXPECT_EQ(store_.prune(chosen), bytes);
  for (const CheckpointRecord& record : chosen) EXPECT_FALSE(there(record));
  EXPECT_EQ(cycles(store_.checkpoints(run_id(0))), (std::vector<double>{0, 3, 6}));
  EXPECT_EQ(store_.checkpoints(run_id(0), Listed::all).size(), 7u);
  EXPECT_EQ(store_.stage(run_id(0)).step, before[0].step);
  EXPECT_EQ(store_.stage(run_id(0)).state, StageState::completed);
  EXPECT_TRUE(store_.prunable({{}, 3}).empty());
  const VerifyReport report = store_.verify();
  EXPECT_TRUE(report.ok());
  EXPECT_TRUE(report.findings.empty()) << report.findings[0].message;
  EXPECT_EQ(report.checkpoints, 5u);
  store_.rebuild();
  EXPECT_TRUE(store_.verify().ok());

  expect_refused<FilePruned>(
      [&] { store_.load_checkpoint(store_.find_checkpoint(chosen[0].sha256).value()); },
      {"shearcell regenerate " + chosen[0].sha256.substr(0, 12)});
  EXPECT_THROW(store_.load_checkpoint(chosen[0]), FilePruned) << "an older record of it";
}

TEST_F(PruneTest, KeepsTheNewestThatCanBeRead) {
  fs::resize_file(path_ / records_[6].file, 100);
  fs::remove(path_ / records_[5].file);
  EXPECT_EQ(cycles(store_.prunable({{run_id(0)}, 0})), (std::vector<double>{0, 1, 2}));
  // The newest is kept even when it is named.
  EXPECT_EQ(store_.prune({records_[6]}), 0u);
  EXPECT_TRUE(there(records_[6]));
}

TEST_F(PruneTest, FinishesAnInterruptedPrune) {
  const std::string file = read_bytes(path_ / records_[1].file);
  store_.prune({records_[1]});
  write_bytes(path_ / records_[1].file, file);  // as if it had died before the removal
  const VerifyReport report = store_.verify();
  EXPECT_TRUE(report.ok());
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_EQ(report.findings[0].subject, records_[1].file);
  EXPECT_THROW(store_.load_checkpoint(store_.find_checkpoint(records_[1].sha256).value()),
               FilePruned);
  const auto left = store_.prune_leftovers();
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(store_.prune(left), records_[1].size);
  EXPECT_FALSE(there(records_[1]));
  EXPECT_TRUE(store_.prune_leftovers().empty());
}

TEST_F(PruneTest, RestoresTheSameBytesOnly) {
  const std::string before = read_bytes(path_ / records_[1].file);
  store_.prune({records_[1]});
  Checkpoint other = sample_checkpoint(run_id(0), kCycle);
  other.state.velocity(1, 1) += 1e-9;
  EXPECT_THROW(store_.restore_checkpoint(records_[1], other), StoreDamaged);
  Checkpoint same_state = sample_checkpoint(run_id(0), kCycle);
  same_state.observables["phi"] = 0.1;
  EXPECT_THROW(store_.restore_checkpoint(records_[1], same_state), StoreDamaged);
  EXPECT_FALSE(there(records_[1]));
  store_.restore_checkpoint(records_[1], sample_checkpoint(run_id(0), kCycle));
  EXPECT_EQ(read_bytes(path_ / records_[1].file), before);
  EXPECT_EQ(store_.events("run/" + run_id(0)).back().type, "CheckpointRegenerated");
  EXPECT_EQ(store_.checkpoints(run_id(0)).size(), 7u);
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(PruneTest, AcceptsAPrunedStateThatIsRecordedAgain) {
  store_.prune({records_[8]});
  store_.start_stage(run_id(1), {}, records_[9].sha256);
  store_.record_checkpoint(run_id(1), sample_checkpoint(run_id(1), kCycle));
  EXPECT_EQ(store_.checkpoints(run_id(1)).size(), 3u);
  EXPECT_TRUE(there(records_[8]));
  EXPECT_TRUE(store_.verify().ok());
}

}  // namespace
}  // namespace shearcell
