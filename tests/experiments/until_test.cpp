// SPDX-License-Identifier: GPL-3.0-or-later
// `until`: a run ends when a measure reaches a value, at the same checkpoint in every program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/measures.hpp"
#include "core/drive.hpp"
#include "experiments/figures/draw.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

Ask ask(std::uint64_t cycles, std::optional<Until> until = std::nullopt, std::uint64_t every = 1) {
  Ask made;
  made.checkpoint_every = every;
  made.target_cycles = cycles;
  if (until) made.until = to_json(*until);
  return made;
}

struct Seen {
  std::vector<CheckpointRecord> checkpoints;
  KnownMeasures measures;
};

// Checkpoints at cycles 0, 2, 4, ... with these percentages.
Seen measured(std::initializer_list<double> percentages) {
  Seen seen;
  for (const double percent : percentages) {
    CheckpointRecord& next = seen.checkpoints.emplace_back();
    next.cycle = 2 * static_cast<double>(seen.checkpoints.size() - 1);
    next.sha256 = std::to_string(next.cycle);
    seen.measures[next.sha256].numbers["crystalline_percent"] = percent;
  }
  return seen;
}

// Why a running stage with these checkpoints ends at the last one.
nlohmann::json ended(std::span<const Ask> asks, const Seen& seen) {
  Stage stage;
  stage.state = StageState::running;
  stage.cycle = seen.checkpoints.back().cycle;
  return outlook(stage, asks, seen.checkpoints, seen.measures).ended;
}

TEST(OutlookOfUntil, IsTheLongestThatAnyExperimentAsksFor) {
  const Until ten{"crystalline_percent", 10, 0};
  const Until later{"crystalline_percent", 10, 3};
  const Until twenty{"crystalline_percent", 20, 0};
  struct Case {
    std::vector<Ask> asks;
    Seen measured;
    double reached;  // cycle; -1: the run continues
  };
  const std::vector<Case> cases = {
      {{ask(50, ten)}, measured({1, 9.99}), -1},
      {{ask(50, ten)}, measured({1, 10}), 2},
      {{ask(50, ten)}, measured({1, 12, 3}), 2},  // reached once is reached
      {{ask(50, ten)}, measured({1, NAN}), -1},   // a cell without interior grains
      {{ask(50, ten)}, measured({NAN, 10}), 2},
      {{ask(50, later)}, measured({1, 10, 11}), -1},    // cycle 4 of 5
      {{ask(50, later)}, measured({1, 10, 11, 9}), 2},  // the first checkpoint at or after 5
      {{ask(50, ten, 4)}, measured({1, 10}), -1},       // it has no checkpoint at cycle 2
      {{ask(50, ten, 4)}, measured({1, 10, 10}), 4},
      {{ask(50, later, 4)}, measured({1, 1, 10, 10}), -1},  // cycle 6 of 7, its next is 8
      {{ask(50, later, 4)}, measured({1, 1, 10, 10, 10}), 4},
      {{ask(50, ten), ask(50, twenty)}, measured({1, 10}), -1},
      {{ask(50, ten), ask(50, twenty)}, measured({1, 10, 20}), 4},
      {{ask(50, ten), ask(4)}, measured({1, 10}), -1},  // another wants four cycles
      {{ask(50, ten), ask(4)}, measured({1, 10, 10}), 2},
      {{ask(4, twenty)}, measured({1, 10, 10}), -1},  // its last cycle, as without `until`
      {{}, measured({99}), -1},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(&c - cases.data());
    const nlohmann::json why = ended(c.asks, c.measured);
    ASSERT_EQ(!why.is_null(), c.reached >= 0);
    EXPECT_EQ(why.is_null() ? -1 : why.at("reached_at_cycle").get<double>(), c.reached);
  }
}

TEST(OutlookOfUntil, IsDescribed) {
  const nlohmann::json why =
      ended(std::vector{ask(9, Until{"crystalline_percent", 10, 2})}, measured({1, 10, 20}));
  ASSERT_FALSE(why.is_null());
  EXPECT_EQ(describe_end(why), "crystalline_percent >= 10 at cycle 2, then 2 more cycles");
  EXPECT_EQ(describe_end(nullptr), "");
}

// The packing densifies, so phi ends the runs. One run of six cycles gives the cycle.
class UntilTest : public StoreTest {
 protected:
  static void SetUpTestSuite() {
    whole_folder_ = new TemporaryFolder;
    Store store(whole_folder_->path() / "store", Access::create);
    compute(store, manifest(""));
    const Stage run = sheared(store);
    whole_ = new std::vector<CheckpointRecord>(store.checkpoints(run.id));
    ASSERT_EQ(whole_->size(), 7U);
    std::vector<double> phi;
    for (const CheckpointRecord& record : *whole_) {
      phi.push_back(analyse(store.load_checkpoint(record)).measures.phi);
    }
    // Reached at the densest of the first three checkpoints under shear, or before.
    value_ = *std::max_element(phi.begin() + 1, phi.begin() + 4);
    const auto first = std::find_if(phi.begin(), phi.end(), [](double p) { return p >= value_; });
    end_ = static_cast<std::size_t>(first - phi.begin()) + 1;
    ASSERT_LE(end_, 4U);
  }
  static void TearDownTestSuite() {
    delete whole_;
    delete whole_folder_;
  }

  static std::string manifest(const std::string& rest) {
    return tiny_manifest("  cycles: 6\n", rest);
  }
  static std::string until(std::uint64_t extra_cycles = 1) {
    return fmt::format("until: {{phi: {}, extra_cycles: {}}}\n", value_, extra_cycles);
  }

  // The checkpoints on the cadence are those of the whole run, up to where this one ended.
  static void expect_end(const Store& store, std::size_t last) {
    const Stage run = sheared(store);
    EXPECT_EQ(run.state, StageState::completed);
    std::vector<CheckpointRecord> whole_cycles = store.checkpoints(run.id);
    std::erase_if(whole_cycles,
                  [](const CheckpointRecord& c) { return c.cycle != std::floor(c.cycle); });
    ASSERT_EQ(whole_cycles.size(), last + 1);
    for (std::size_t i = 0; i <= last; ++i) {
      EXPECT_EQ(whole_cycles[i].state_hash, (*whole_)[i].state_hash) << "cycle " << i;
      EXPECT_EQ(whole_cycles[i].sha256, (*whole_)[i].sha256) << "cycle " << i;
    }
    EXPECT_TRUE(store.verify().ok());
  }

  std::optional<double> expected(std::uint64_t extra_cycles) const {
    return expected_end(store_.stages(), to_json(Until{"phi", value_, extra_cycles}));
  }

  static inline TemporaryFolder* whole_folder_ = nullptr;
  static inline std::vector<CheckpointRecord>* whole_ = nullptr;
  static inline double value_ = 0;
  static inline std::size_t end_ = 0;  // cycle
};

TEST_F(UntilTest, EndsTheRunWithItsReasonAndKeepsTheMeasures) {
  EXPECT_EQ(compute(store_, manifest(until())).completed, 2U);
  expect_end(store_, end_);
  const Stage run = sheared(store_);
  const nlohmann::json why = end_of(run);
  EXPECT_EQ(why.at("measure"), "phi");
  EXPECT_EQ(why.at("reached_at_cycle"), static_cast<double>(end_ - 1));
  EXPECT_EQ(why.at("extra_cycles"), 1U);
  EXPECT_EQ(expected(1), static_cast<double>(end_));
  EXPECT_EQ(expected(2), std::nullopt);

  // Once it is reached, nothing more is measured.
  DerivedCache cache(store_.folder());
  for (const CheckpointRecord& record : store_.checkpoints(run.id)) {
    const bool before = record.cycle < static_cast<double>(end_);
    for (const char* name : {"scalars", "crystallites"}) {
      const DerivedKey key{record.sha256, provider(name).key(), analysis_version};
      EXPECT_EQ(cache.get(std::span(&key, 1)).front().has_value(), before) << record.cycle;
    }
  }
  // Asking again asks for nothing.
  const Head head = store_.head();
  EXPECT_EQ(compute(store_, manifest(until())).already, 2U);
  EXPECT_EQ(store_.head().hash, head.hash);
  // The projections of such a run can be rebuilt.
  store_.rebuild();
  expect_end(store_, end_);
}

TEST_F(UntilTest, RunsAreExtendedWithoutUntilOrWithALaterOne) {
  compute(store_, manifest(until(0)));
  expect_end(store_, end_ - 1);
  EXPECT_EQ(compute(store_, manifest(until(2))).completed, 1U);
  expect_end(store_, end_ + 1);
  EXPECT_EQ(compute(store_, manifest(until(1))).already, 2U) << "nothing is stepped";
  expect_end(store_, end_ + 1);
  EXPECT_EQ(compute(store_, manifest("")).completed, 1U);
  expect_end(store_, 6);
  EXPECT_TRUE(end_of(sheared(store_)).is_null());
}

// A number of another analysis, then one of the log, which another experiment waits for.
TEST_F(UntilTest, AnyNumberOfACheckpointEndsRuns) {
  compute(store_, manifest("until: {contact_pressure_Pa: 1e-9, extra_cycles: 1}\n"));
  expect_end(store_, 1);
  EXPECT_EQ(end_of(sheared(store_)).at("reached_at_cycle"), 0);
  const std::string time = fmt::format("until: {{time_s: {}}}\n", whole_->at(3).time_s);
  EXPECT_EQ(compute(store_, renamed(manifest(time), "twin")).completed, 1U);
  expect_end(store_, 3);
  EXPECT_EQ(end_of(sheared(store_)).at("measure"), "time_s");
}

TEST_F(UntilTest, RunsAreExtendedFromCycleZero) {
  compute(store_, manifest("until: {phi: 0.1}\n"));
  expect_end(store_, 0);
  EXPECT_EQ(compute(store_, manifest("")).completed, 1U);
  expect_end(store_, 6);
}

TEST_F(UntilTest, ARunHasWorkLeftForAPlanWithALaterOne) {
  compute(store_, manifest(until(0)));
  const auto plan_of = [](const std::string& text) {
    return expand(parse_manifest(text, "tiny.yaml"), {});
  };
  const auto look = [&](const std::vector<Plan>& plans) {
    return look_at(plans, &store_).at(1).look;
  };
  // The step from which the run is computed up to its end.
  const auto first_step = [&](const std::vector<Plan>& plans) {
    const PlannedStage run = look_at(plans, &store_).at(1);
    EXPECT_TRUE(run.look.missing.empty());
    return run.look.end * static_cast<double>(cycle_steps(shear_drive(run.stage).value())) -
           run.look.particle_steps / static_cast<double>(run.stage.grains);
  };
  const auto recorded = static_cast<double>(sheared(store_).step);
  const Plan early = plan_of(manifest(until(0))), late = plan_of(renamed(manifest(until(1)), "b"));
  for (const auto& plans : {std::vector{early, late}, std::vector{late, early}}) {
    EXPECT_FALSE(look(plans).done);
    EXPECT_EQ(first_step(plans), recorded);
  }
  EXPECT_TRUE(look({early}).done);
  const Plan seldom =
      plan_of(renamed(manifest(until(0)), "c") + "checkpoints: {every_cycles: 5}\n");
  EXPECT_FALSE(look({seldom}).done) << "it may end at cycle 5 only";
  EXPECT_EQ(first_step({seldom}), recorded);
}

TEST_F(UntilTest, TheLongestOfTwoExperimentsCounts) {
  declared(store_, manifest(until(0)));
  declared(store_, renamed(tiny_manifest("  cycles: 5\n"), "twin"));
  EXPECT_EQ(resume(store_).completed, 2U);
  expect_end(store_, 5);
}

TEST_F(UntilTest, TheReasonIsThatOfTheLongestOfTwoExperiments) {
  compute(store_, renamed(tiny_manifest("  cycles: 5\n"), "twin"));
  EXPECT_EQ(compute(store_, manifest(until(0))).already, 2U) << "nothing is stepped";
  const Stage run = sheared(store_);
  EXPECT_EQ(run.cycle, 5);
  EXPECT_EQ(run.state, StageState::completed);
  const nlohmann::json why = end_of(run);
  EXPECT_EQ(why.at("cycles_asked"), 5);
  EXPECT_TRUE(describe_end(why).starts_with("an experiment asks for 5 cycles; phi >= "));
  EXPECT_EQ(expected(0), std::nullopt);
  EXPECT_FALSE(run.ends.back().contains("cycles_asked"));
}

TEST_F(UntilTest, TheReasonIsNotAnEarlierUntil) {
  compute(store_, manifest(until(0)), {.cycles = 9});
  compute(store_, renamed(tiny_manifest("  cycles: 5\n", "until: {phi: 0.99}\n"), "twin"));
  const Stage run = sheared(store_);
  EXPECT_EQ(run.cycle, 5);
  EXPECT_TRUE(has(describe_end(end_of(run)), "an experiment asks for 5 cycles"));
}

// Its figures and tables are the same whether or not another experiment continues its runs.
TEST_F(UntilTest, EndsRunsInFiguresToo) {
  const WantedFigure s2{*find_figure("S2"), "tiny"};
  RunSelection tiny;
  tiny.experiments = {"tiny"};
  const auto rows = [&] { return to_csv(run_table(store_, tiny, RowPer::checkpoint, {}).table); };
  compute(store_, manifest(until()));
  const nlohmann::json alone = compute_figure(store_, s2, {}).lineage;
  const std::string table = rows();
  EXPECT_EQ(compute(store_, renamed(manifest(""), "twin")).completed, 1U);
  expect_end(store_, 6);
  EXPECT_EQ(compute_figure(store_, s2, {}).lineage, alone);
  EXPECT_EQ(rows(), table);
  std::filesystem::remove(store_.folder() / DerivedCache::kFile);
  EXPECT_EQ(compute_figure(store_, s2, {}).lineage, alone) << "measured again";
}

TEST_F(UntilTest, FiguresEndAtTheNumberOfCyclesWhereUntilIsNotReached) {
  compute(store_, tiny_manifest("  cycles: 3\n", "until: {phi: 0.99}\n"));
  compute(store_, renamed(manifest(""), "twin"));
  const CollectedRuns collected = collect_runs(store_, {*find_figure("S2"), "tiny"}, {});
  EXPECT_EQ(collected.runs.at(0).stage.cycle, 6);
  EXPECT_EQ(collected.runs.at(0).end, 3);
  EXPECT_EQ(collected.runs.at(0).checkpoints.back().cycle, 3);
}

// A checkpoint that may decide the end is neither readable nor cached. The recorded end is known.
TEST_F(UntilTest, IsNotDecidedWithoutTheCheckpointsThatDecideIt) {
  compute(store_, manifest(until()));
  const auto prune_and_forget = [&] {
    store_.prune(store_.prunable({}));
    std::filesystem::remove(store_.folder() / DerivedCache::kFile);
  };
  prune_and_forget();
  const CampaignResult result = compute(store_, manifest(until(3)));
  EXPECT_EQ(result.blocked, 1U);
  ASSERT_EQ(result.messages.size(), 1U);
  EXPECT_TRUE(has(result.messages[0],
                  "was pruned, but it may decide where the run ends (`until`); "
                  "`shearcell regenerate"))
      << result.messages[0];
  EXPECT_EQ(sheared(store_).cycle, static_cast<double>(end_));
  for (const CheckpointRecord& record : replayable(store_)) {
    if (record.state == CheckpointState::pruned) regenerate_checkpoint(store_, record);
  }
  compute(store_, renamed(manifest(""), "twin"));
  const Stage run = sheared(store_);
  const auto end = [&](std::size_t extra) {
    return end_for(store_, run, ask(6, Until{"phi", value_, extra}), {});
  };
  EXPECT_EQ(end(1), static_cast<double>(end_));
  prune_and_forget();
  EXPECT_EQ(end(1), static_cast<double>(end_)) << "as recorded";
  EXPECT_THROW(end(2), FilePruned) << "this was never recorded";
}

TEST_F(UntilTest, MeasuresOverTwoCheckpointsKeepTheCadenceOfTheirExperiment) {
  compute(store_, tiny_manifest("  cycles: 4\n", "checkpoints: {every_cycles: 2}\n"));
  compute(store_, renamed(tiny_manifest("  cycles: 4\n"), "twin"));
  const Table table = run_table(store_, {}, RowPer::checkpoint, {}).table;
  const std::size_t experiment = table.place("experiment"), moved = table.place("msd_1_cycle_d2");
  std::map<std::string, int> known;
  for (const auto& row : table.rows)
    known[std::get<std::string>(row[experiment])] += row[moved] == TableCell() ? 0 : 1;
  EXPECT_EQ(known, (std::map<std::string, int>{{"tiny", 0}, {"twin", 4}}));
}

TEST_F(UntilTest, AnExperimentKeepsItsCadenceInTables) {
  RunSelection tiny;
  tiny.experiments = {"tiny"};
  const auto rows = [&] {
    return run_table(store_, tiny, RowPer::checkpoint, {}).table.rows.size();
  };
  compute(store_, tiny_manifest("  cycles: 3\n", "checkpoints: {every_cycles: 2}\n"));
  EXPECT_EQ(rows(), 3U) << "cycles 0, 2 and 3";
  compute(store_, renamed(manifest(""), "twin"));
  EXPECT_EQ(rows(), 3U);
}

TEST_F(UntilTest, IsTheSameAfterInterruptionsWithinCycles) {
  const std::vector<StageJob> jobs = declared(store_, manifest(until()));
  run_stage(store_, jobs[0].id, {});
  bool second = false;
  const std::size_t interrupted = interrupt_to_the_end(store_, jobs[1].id, [&] {
    // Whoever continues may have to measure again.
    if (second) std::filesystem::remove(store_.folder() / DerivedCache::kFile);
    second = !second;
  });
  EXPECT_GE(interrupted, 3U);
  expect_end(store_, end_);
}

}  // namespace
}  // namespace shearcell::test
