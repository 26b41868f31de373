// SPDX-License-Identifier: GPL-3.0-or-later
// Every recorded state can be recomputed to the last bit from any state before it. States that
// cannot be recomputed are distinguished from changed ones.
#include "experiments/runner/audit.hpp"
#include "experiments/runner/stage.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "core/simulation.hpp"
#include "core/watchdog.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "provenance/errors.hpp"
#include "provenance/sha256.hpp"
#include "tests/experiments/drawing.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

class ReplayTest : public DrawingTest {
 protected:
  ReplayTest() { compute(store_, tiny_manifest("  cycles: 4\n")); }

  Stage sheared() const { return test::sheared(store_); }
  Stage packing() const { return runs_of_kind(store_, "prepare").at(0); }
  bool there(const CheckpointRecord& record) const {
    return std::filesystem::exists(store_.folder() / record.file);
  }
};

TEST_F(ReplayTest, ReproducesEveryRecordedState) {
  const auto all = replayable(store_);
  ASSERT_EQ(all.size(), store_.checkpoints(packing().id).size() + 5);
  const auto before = final_hashes(store_);
  for (const CheckpointRecord& record : all) {
    const Replay replay = verify_by_replay(store_, record, 1);
    EXPECT_FALSE(replay.divergence) << replay.divergence->message;
    EXPECT_EQ(replay.steps, record.step - (replay.from ? replay.from->step : 0));
  }
  EXPECT_EQ(count_events(store_, "ReplayVerified"), all.size());
  EXPECT_EQ(final_hashes(store_), before);
  for (const Stage& run : store_.stages()) EXPECT_EQ(run.state, StageState::completed);
  EXPECT_TRUE(store_.verify().ok());
}

// This run's time step is so near the stability limit that at the ends of some cycles, which are no
// multiples of 1024 steps, the watchdog's bound is over it.
TEST_F(ReplayTest, FailsNowhereThatTheRunDidNot) {
  const auto manifest = [](const char* cycles) {
    return fmt::format(
        "experiment: near\nquestion: q\nbase: {{grains: 200, period_s: 0.0625, steps_per_cycle: "
        "512, amplitude_rad: 0.1, cycles: {}}}\nseeds: [34]\n",
        cycles);
  };
  const TemporaryFolder folder;
  Store parts(folder.path() / "store", Access::create);
  compute(parts, manifest("13"));
  compute(parts, manifest("31"));
  EXPECT_EQ(final_hashes(parts), undisturbed(manifest("31")));
  const Stage run = test::sheared(parts);
  const Scene scene = shear_scene(read_stage(run.resolved).parameters);
  int over = 0;
  for (const CheckpointRecord& record : parts.checkpoints(run.id)) {
    Checkpoint begun = parts.load_checkpoint(record);
    begun.state.step = 0;
    Simulation simulation(begun.cell, scene, begun.state);
    simulation.set_overlap_limit(kLargestOverlapLimit);
    try {
      simulation.advance(Drive{}, 1);
    } catch (const NumericalFailure&) {
      ++over;
    }
  }
  EXPECT_GT(over, 0) << "the case is too easy";
  for (const CheckpointRecord& record : replayable(parts)) {
    EXPECT_FALSE(verify_by_replay(parts, record, 1).divergence) << record.step;
  }
}

TEST_F(ReplayTest, RecordsNothingIfInterruptedWhileTheCellIsFilled) {
  const StopWish withdrawn_at_the_end;
  request_stop(true);
  EXPECT_TRUE(verify_by_replay(store_, store_.checkpoints(packing().id).front(), 1).interrupted);
  EXPECT_EQ(count_events(store_, "ReplayVerified") + count_events(store_, "ReplayDiverged"), 0U);
}

TEST_F(ReplayTest, SamplesWithoutRepetitionAndEquallyForEqualSeeds) {
  const auto all = replayable(store_);
  const auto names = [](const std::vector<CheckpointRecord>& records) {
    std::vector<std::string> found;
    for (const CheckpointRecord& record : records) found.push_back(record.sha256);
    return found;
  };
  const auto three = names(sample(all, 3, 7));
  EXPECT_EQ(std::set<std::string>(three.begin(), three.end()).size(), 3U);
  EXPECT_EQ(names(sample(all, 3, 7)), three);
  EXPECT_NE(names(sample(all, 3, 8)), three);
  EXPECT_EQ(sample(all, 100, 7).size(), all.size());
}

TEST_F(ReplayTest, RecreatesPrunedCheckpoints) {
  const auto records = store_.checkpoints(sheared().id);
  std::map<std::string, std::string> bytes;
  for (const CheckpointRecord& r : records) bytes[r.sha256] = read_bytes(store_.folder() / r.file);
  store_.prune(store_.prunable({.runs = {sheared().id}, .keep_every = 0}));
  EXPECT_EQ(cycles_of(store_, sheared().id), std::vector<double>{4});

  // From the packing, across two pruned ones; then from the nearest kept one; then cycle 0 itself.
  for (const auto& [at, steps] : {std::pair(2, 2 * kStepsPerCycle), std::pair(3, kStepsPerCycle),
                                  std::pair(0, std::size_t{0})}) {
    const CheckpointRecord& record = records[static_cast<std::size_t>(at)];
    ASSERT_FALSE(there(record));
    const Replay replay = regenerate_checkpoint(store_, record);
    ASSERT_FALSE(replay.divergence) << replay.divergence->message;
    EXPECT_EQ(replay.steps, steps);
    EXPECT_EQ(read_bytes(store_.folder() / record.file), bytes.at(record.sha256));
  }
  EXPECT_EQ(cycles_of(store_, sheared().id), (std::vector<double>{0, 2, 3, 4}));
  EXPECT_EQ(count_events(store_, "CheckpointRegenerated"), 3U);
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(ReplayTest, RepairsADamagedFile) {
  const auto records = store_.checkpoints(sheared().id);
  truncate_file(store_.folder() / records[2].file);
  EXPECT_FALSE(store_.verify().ok());
  EXPECT_FALSE(regenerate_checkpoint(store_, records[2]).divergence);
  EXPECT_TRUE(store_.verify().ok());
  store_.reject_checkpoint(sheared().id, records[4].sha256, "a test");
  EXPECT_EQ(store_.stage(sheared().id).cycle, 3);
  EXPECT_FALSE(regenerate_checkpoint(store_, records[4]).divergence);
  EXPECT_EQ(store_.stage(sheared().id).cycle, 4);
}

// The settled packing is damaged, and states of its settling are intact.
TEST_F(ReplayTest, DoesNotStartFromAnUnsettledPacking) {
  Store other(folder_.path() / "other", Access::create);
  const std::vector<StageJob> jobs = declared(other, tiny_manifest());
  interrupt_to_the_end(other, jobs[0].id);
  ASSERT_GT(other.checkpoints(jobs[0].id).size(), 1U);
  ASSERT_EQ(run_stage(other, jobs[1].id, {}), StageOutcome::completed);
  const CheckpointRecord settled = other.checkpoints(jobs[0].id).back();
  truncate_file(other.folder() / settled.file);
  const CheckpointRecord first = other.checkpoints(jobs[1].id).front();
  EXPECT_THROW(regenerate_checkpoint(other, first), StoreDamaged);
  EXPECT_EQ(count_events(other, "ReplayDiverged"), 0U);
  EXPECT_FALSE(regenerate_checkpoint(other, settled).divergence) << "as the message says";
  EXPECT_FALSE(regenerate_checkpoint(other, first).divergence);
}

TEST_F(ReplayTest, WorksOnPackingsAndOnStatesWithinACycle) {
  // Interrupted after a chunk of steps, and so within the settling and within a cycle.
  Store other(folder_.path() / "other", Access::create);
  for (const StageJob& job : declared(other, tiny_manifest())) {
    interrupt_to_the_end(other, job.id);
  }
  const auto records = replayable(other);
  ASSERT_GT(records.size(), 10U);
  other.prune(other.prunable({}));
  for (const CheckpointRecord& record : records) {
    if (std::filesystem::exists(other.folder() / record.file)) continue;
    const Replay replay = regenerate_checkpoint(other, record);
    EXPECT_FALSE(replay.divergence) << replay.divergence->message;
  }
  EXPECT_EQ(replayable(other).size(), records.size());
  const VerifyReport report = other.verify();
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.checkpoints, records.size());
}

// A state that no computation gives, well recorded: as by a processor that erred.
TEST_F(ReplayTest, ReportsWhereAStateDiverges) {
  const auto records = store_.checkpoints(sheared().id);
  Checkpoint wrong = store_.load_checkpoint(records[4]);
  wrong.state.step += kStepsPerCycle;
  wrong.cycle = 5;
  wrong.state.velocity(1, 17) += 0.25;
  declared(store_, tiny_manifest("  cycles: 4\n"), {.cycles = 6});
  store_.start_stage(sheared().id, {}, records[4].sha256);
  const CheckpointRecord record = store_.record_checkpoint(sheared().id, wrong);
  store_.interrupt_stage(sheared().id, "a test");

  const Replay replay = verify_by_replay(store_, record);
  ASSERT_TRUE(replay.divergence);
  EXPECT_EQ(replay.divergence->same_step, records[4].step);
  EXPECT_EQ(replay.divergence->first_step, record.step);
  EXPECT_FALSE(replay.divergence->field.empty());
  EXPECT_GT(replay.divergence->ulp, 0U);
  std::printf("%s: %s of grain %lld, %llu ulp\n", replay.divergence->message.c_str(),
              replay.divergence->field.c_str(), static_cast<long long>(replay.divergence->grain),
              static_cast<unsigned long long>(replay.divergence->ulp));
  const Event last = store_.events("run/" + sheared().id).back();
  EXPECT_EQ(last.type, "ReplayDiverged");
  EXPECT_EQ(last.body().at("first_step"), record.step);

  // Regenerating it keeps nothing, and says so.
  std::filesystem::remove(store_.folder() / record.file);
  const Replay again = regenerate_checkpoint(store_, record);
  ASSERT_TRUE(again.divergence);
  EXPECT_EQ(again.divergence->field, "") << "there is nothing to compare with";
  EXPECT_FALSE(there(record));
  EXPECT_EQ(count_events(store_, "ReplayDiverged"), 2U);
}

TEST_F(ReplayTest, FiguresNamePrunedCheckpoints) {
  const auto records = store_.checkpoints(sheared().id);
  store_.prune({records[1], records[2]});
  const ComputedFigure figure = draw("figures");
  EXPECT_TRUE(figure.damage.empty());
  ASSERT_EQ(figure.pruned.size(), 2U);
  for (const std::string& line : figure.pruned) {
    EXPECT_TRUE(has(line, "shearcell regenerate"));
  }
  for (const std::size_t at : {1U, 2U}) regenerate_checkpoint(store_, records[at]);
  EXPECT_TRUE(draw("figures").pruned.empty());
}

}  // namespace
}  // namespace shearcell::test
