// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of checkpoints are cached, and a figure is the same from cached or new measures.
#include "experiments/runner/measure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <span>

#include "experiments/figures/collect.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/sqlite.hpp"
#include "tests/experiments/drawing.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

class Measure : public DrawingTest {
 protected:
  void SetUp() override { compute(store_, tiny_manifest("", kBothFluids)); }

  ComputedFigure make(const std::string& name) { return draw(name, kS2); }
  std::string csv(const std::string& name) const {
    const std::filesystem::path folder = folder_.path() / name / "tiny/base";
    return read_bytes(folder / "S2a.csv") + read_bytes(folder / "S2b.csv");
  }
  /// Of `verify --measures` with every checkpoint.
  std::vector<Finding> findings() const { return check_measures(store_, 1000, 1).findings; }
  std::filesystem::path cache() const { return store_.folder() / DerivedCache::kFile; }
  void sql(const std::string& statement) const {
    sqlite::Database(cache(), Access::write).execute(statement);
  }
  /// Keeps another phi of a checkpoint, under a right digest.
  void keep_phi(const CheckpointRecord& record, double phi) const {
    DerivedCache kept(store_.folder());
    const DerivedKey key{record.sha256, provider("scalars").key(), analysis_version};
    nlohmann::json scalars = decode_result(kept.get(std::span(&key, 1)).front().value());
    scalars["phi"] = phi;
    const DerivedObject object{key, encode_result(scalars)};
    kept.put(std::span(&object, 1));
  }
  std::vector<CheckpointRecord> records() const {
    std::vector<CheckpointRecord> all;
    for (const Stage& run : runs_of_kind(store_, "shear")) {
      for (const CheckpointRecord& record : store_.checkpoints(run.id)) all.push_back(record);
    }
    return all;
  }
};

TEST_F(Measure, IsMeasuredOnceAndGivesTheSameBytes) {
  EXPECT_EQ(make("first").measured.size(), 6U);
  EXPECT_EQ(make("second").measured.size(), 0U);
  std::filesystem::remove(cache());
  EXPECT_EQ(make("third").measured.size(), 6U);
  for (const char* other : {"second", "third"}) EXPECT_EQ(csv(other), csv("first"));
  EXPECT_TRUE(store_.verify().findings.empty()) << "what is kept is no orphan";
}

// With a known sample, a forger could change all other values.
TEST_F(Measure, AMergeChecksAnUnpredictableSample) {
  make("first");
  const std::vector<CheckpointRecord> known = sample(records(), 3, 1);
  for (const CheckpointRecord& record : records()) {
    if (std::ranges::count(known, record.sha256, &CheckpointRecord::sha256) > 0) continue;
    keep_phi(record, 0.9);
  }
  // One merge of twenty takes these three.
  bool refused = false;
  for (int merge = 0; merge < 8 && !refused; ++merge) {
    Store into(folder_.path() / ("into" + std::to_string(merge)), Access::create);
    refused = !merge_stores(into, {store_.folder()}).at(0).refused.empty();
  }
  EXPECT_TRUE(refused);
}

TEST_F(Measure, OnlyNewCheckpointsAreMeasured) {
  make("short");
  compute(store_, tiny_manifest("", kBothFluids), {.cycles = 3});
  EXPECT_EQ(make("long").measured.size(), 2U);
  std::filesystem::remove(cache());
  EXPECT_EQ(make("again").measured.size(), 8U);
  EXPECT_EQ(csv("again"), csv("long"));
}

TEST_F(Measure, CurvesAndMotionArePlotted) {
  const std::string plots =
      "plots: [{name: g, y: pair_correlation, at_cycle: 1}, "
      "{name: each, y: phi_profile, show: traces}, {name: moved, y: msd_1_cycle_d2, log: y}]\n";
  compute(store_, tiny_manifest("", kBothFluids + plots));
  for (const char* name : {"g", "each", "moved"}) EXPECT_TRUE(draw("own", name).undrawn.empty());
  const auto files = contents("own");
  EXPECT_TRUE(files.at("g.csv").starts_with("variant,distance_d,pair_correlation_mean,"));
  EXPECT_TRUE(has(files.at("g.gp"), "distance"));
  EXPECT_TRUE(has(files.at("each.csv"), "height_d,phi_profile_mean"));
  const std::string& moved = files.at("moved.csv");
  const std::string head = "variant,cycle,msd_1_cycle_mean_d2,msd_1_cycle_standard_error_d2,runs\n";
  EXPECT_TRUE(moved.starts_with(head + "fluid=cell,0,,,0\nfluid=cell,1,0.")) << moved;
}

const std::string kBothAmplitudes = "sweep: {grid: {amplitude_rad: [0.05, 0.1]}}\n";

/// The cycles of every run of a lineage file.
nlohmann::json lineage_cycles(const std::string& lineage) {
  nlohmann::json cycles = nlohmann::json::array();
  const auto facts = nlohmann::json::parse(lineage);
  for (const auto& input : facts.at("inputs")) cycles.push_back(input.at("cycles"));
  return cycles;
}

// The values at cycle 2 come from the checkpoints of cycles 1 and 2.
TEST_F(Measure, EarlierCheckpointsAreInTheLineageAndMissedIfTheyAreGone) {
  const std::string plots =
      "plots: [{name: moved, y: msd_1_cycle_d2, x: amplitude_rad, at_cycle: 2}, "
      "{name: work, y: work_of_walls_per_cycle_J, x: amplitude_rad, at_cycle: 2}]\n"
      "claims: [{name: same, compare: phi, at_cycle: 1, margin: 1, "
      "between: [{amplitude_rad: 0.05}, {amplitude_rad: 0.1}]}]\n";
  compute(store_, tiny_manifest("", kBothAmplitudes + plots));
  for (const char* name : {"moved", "work", "same"}) draw("own", name);
  auto files = contents("own");
  const auto both = nlohmann::json::parse("[[[1, 2, 1]], [[1, 2, 1]]]");
  EXPECT_EQ(lineage_cycles(files.at("moved.lineage.json")), both);
  EXPECT_EQ(lineage_cycles(files.at("work.lineage.json")), both);
  EXPECT_EQ(lineage_cycles(files.at("same.lineage.json")),
            nlohmann::json::parse("[[[1, 1, 1]], [[1, 1, 1]]]"))
      << "a claim has what it compares";

  for (const CheckpointRecord& record : records()) {
    if (record.cycle == 1) std::filesystem::remove(store_.folder() / record.file);
  }
  EXPECT_TRUE(draw("own", "moved").damage.empty()) << "cached";
  std::filesystem::remove(cache());
  for (const char* name : {"moved", "work"}) {
    const ComputedFigure result = draw("own", name);
    EXPECT_EQ(result.damage.size(), 2U) << name;
    EXPECT_TRUE(has(contents("own").at(std::string(name) + ".caption.txt"),
                    "Left out: values that need 2 damaged checkpoints."));
  }
}

// Another experiment of the same runs has a checkpoint at cycle 1.
TEST_F(Measure, EarlierCheckpointsAreThoseOfTheExperiment) {
  const std::string plots =
      "plots: [{name: moved, y: msd_1_cycle_d2, x: amplitude_rad, at_cycle: 2}]\n";
  compute(store_, renamed(tiny_manifest("", kBothAmplitudes), "other"));
  compute(store_, tiny_manifest("", kBothAmplitudes + "checkpoints: {every_cycles: 2}\n" + plots));
  EXPECT_EQ(draw("own", "moved").empty.size(), 1U);
}

TEST_F(Measure, OneAnalysisServesAllFiguresMadeTogether) {
  std::string text =
      tiny_manifest("",
                    "sweep: {grid: {amplitude_rad: [0.05, 0.1]}}\nplots: [{name: core, "
                    "y: core_phi}, {name: fcc, y: cna_fcc_percent}]\n");
  text.replace(text.find("[S2]"), 4, "[S7, walls]");
  compute(store_, text);
  std::vector<std::string> order;
  std::size_t measured = 0;
  for (const WantedFigure& wanted : wanted_figures(store_).figures) {
    order.emplace_back(wanted.figure.name);
    measured += draw("together", wanted).measured.size();
  }
  EXPECT_EQ(order, (std::vector<std::string>{"S7", "walls", "core", "fcc", "table1"}));
  EXPECT_EQ(measured, 6U) << "checkpoints, each once";
}

// A run that two experiments have is a row of each, and counts once.
TEST_F(Measure, RedrawingEveryExperimentMeasuresNothing) {
  compute(store_, renamed(tiny_manifest("", kBothFluids), "other"));
  const ComputedFigure table = draw("table", {*find_figure("table1"), ""});
  EXPECT_EQ(table.measured.size(), 0U);
  EXPECT_EQ(table.runs, 2U);
  EXPECT_EQ(table.checkpoints, 2U) << "the last one of each";
  EXPECT_TRUE(table.verdicts.empty());
  EXPECT_TRUE(has(read_bytes(folder_.path() / "table" / "base" / "table1.csv"), "other,mass_kg,"));
}

TEST_F(Measure, ATableNamesTheExperimentsThatItLeavesOut) {
  ExpandOptions small;
  small.scale = "small";
  declared(store_, renamed(tiny_manifest("", "scales: {small: {grains: 310}}\n"), "other"), small);
  const CollectedRuns found = collect_runs(store_, {*find_figure("table1"), ""}, {});
  EXPECT_EQ(found.scale, "small");
  EXPECT_EQ(found.notes,
            (std::vector<std::string>{"left out: experiments without a run at scale small: tiny"}));
}

TEST_F(Measure, AChangedValueIsFoundAndReplaced) {
  make("first");
  sql("UPDATE derived SET (content, sha256) = (SELECT content, sha256 FROM derived LIMIT 1)");
  EXPECT_EQ(make("second").measured.size(), 5U) << "all but the one whose content it is";
  EXPECT_EQ(csv("second"), csv("first"));
  sql("UPDATE derived SET version = version + 1");
  EXPECT_EQ(make("third").measured.size(), 6U) << "of another version";
  EXPECT_EQ(csv("third"), csv("first"));
}

// As when the analysis was changed and its version was not.
TEST_F(Measure, VerifyNamesCachedValuesThatDiffer) {
  make("first");
  EXPECT_TRUE(findings().empty());
  const CheckpointRecord victim = records().at(2);
  keep_phi(victim, 0.5);
  make("wrong");
  EXPECT_NE(csv("wrong"), csv("first"));
  const std::vector<Finding> found = findings();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(has(found[0].message, victim.sha256.substr(0, 12))) << found[0].message;
  std::filesystem::remove(cache());
  EXPECT_EQ(make("again").measured.size(), 6U);
  EXPECT_EQ(csv("again"), csv("first"));
}

// Only who computes hashes can do this; it must neither crash nor give a wrong number.
TEST_F(Measure, WrongContentUnderARightHashIsRejected) {
  make("first");
  DerivedCache kept(store_.folder());
  DerivedObject object{{records().at(0).sha256, provider("scalars").key(), analysis_version}, {}};
  object.content = {std::byte{0xff}, std::byte{0}};
  kept.put(std::span(&object, 1));
  EXPECT_EQ(make("second").measured.size(), 1U);
  EXPECT_EQ(csv("second"), csv("first"));
  object.content = encode_result(nlohmann::json{{"phi", "dense"}});
  kept.put(std::span(&object, 1));
  EXPECT_THROW(make("third"), StoreDamaged);
  EXPECT_EQ(findings().size(), 1U);
  std::filesystem::remove(cache());
  make("fourth");
  EXPECT_EQ(csv("fourth"), csv("first"));
}

TEST_F(Measure, MeasuresHaveTheOrderOfTheRecordsWithAnyNumberOfWorkers) {
  std::vector<CheckpointRecord> all = records();
  all.push_back(all.front());  // a run that two experiments share
  const std::vector<std::string> two = {"scalars", "pair_correlation"};
  const Measured one = measured(store_, all, two, {.workers = 1});
  std::filesystem::remove(cache());
  const Measured many = measured(store_, all, two, {.workers = 4});
  const Measured kept = measured(store_, all, two, {.workers = 2});
  ASSERT_EQ(one.checkpoints.size(), all.size());
  EXPECT_EQ(one.measured.size(), all.size() - 1);
  EXPECT_EQ(many.measured.size(), all.size() - 1);
  EXPECT_EQ(kept.measured.size(), 0U);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Measures& found = one.checkpoints[i].measures;
    EXPECT_TRUE(one.checkpoints[i].lacking.empty());
    EXPECT_EQ(found.number("phi"), analyse(store_.load_checkpoint(all[i])).measures.phi);
    for (const Measured* other : {&many, &kept}) {
      const Measures& again = other->checkpoints[i].measures;
      EXPECT_TRUE(other->checkpoints[i].lacking.empty());
      EXPECT_EQ(found.numbers, again.numbers);
      EXPECT_EQ(found.curves.at("pair_correlation").x, again.curves.at("pair_correlation").x);
    }
  }
}

TEST_F(Measure, AnotherKeptRestIsNamed) {
  compute(store_, tiny_manifest("", "sweep: {grid: {protocol: [continuous, paused]}}\n"));
  draw("first", {*find_figure("B5"), "tiny"});
  EXPECT_TRUE(findings().empty());
  DerivedKey key;
  key.version = analysis_version;
  {
    sqlite::Database database(cache(), Access::read);
    sqlite::Statement kept(
        database,
        "SELECT checkpoint, measure FROM derived WHERE measure LIKE 'rest %' ORDER BY checkpoint");
    ASSERT_TRUE(kept.step());
    kept.get(key.checkpoint, key.measure);
  }
  DerivedCache kept(store_.folder());
  nlohmann::json other = decode_result(kept.get(std::span(&key, 1)).front().value());
  other["phi_at_rest"] = other["phi_at_rest"].get<double>() + 0.001;
  const DerivedObject object{key, encode_result(other)};
  kept.put(std::span(&object, 1));
  const std::vector<Finding> found = findings();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(has(found[0].message, "phi_at_rest")) << found[0].message;
}

// What was measured before is all that is left of it.
TEST_F(Measure, OfAPrunedCheckpointIsMergedToo) {
  const std::string sparse =
      "checkpoints: {every_cycles: 2}\n"
      "plots: [{name: moved, y: msd_1_cycle_d2, log: y}]\n";
  compute(store_, renamed(tiny_manifest("", kBothFluids + sparse), "sparse"));
  make("first");
  draw("first", "moved");
  store_.prune(store_.prunable({}));
  Store into(folder_.path() / "into", Access::create);
  merge_stores(into, {store_.folder()});
  FigureOptions options;
  options.folder = folder_.path() / "second";
  const ComputedFigure figure = draw_figure(into, kS2, options);
  EXPECT_TRUE(figure.pruned.empty());
  EXPECT_EQ(csv("second"), csv("first"));
  const ComputedFigure moved =
      draw_figure(into, wanted_figures(into, {"moved"}).figures.at(0), options);
  EXPECT_TRUE(moved.pruned.empty()) << "measured for another cadence";
}

TEST_F(Measure, WorksWithoutAWritableCache) {
  make("first");
  std::filesystem::remove(cache());
  std::filesystem::create_directory(cache());
  const ComputedFigure figure = make("second");
  std::printf("%s\n", figure.cache_trouble.c_str());
  EXPECT_NE(figure.cache_trouble, "");
  EXPECT_EQ(figure.measured.size(), 6U);
  EXPECT_EQ(csv("second"), csv("first"));
}

TEST(ReadInParallel, CountsWhatCannotBeReadToo) {
  std::size_t last = 0;
  const MeasureOutcome unread = read_in_parallel(
      3, 2,
      [](std::size_t i) {
        if (i == 1) throw StoreDamaged("cut off");
      },
      [&](std::size_t done, std::size_t) { last = done; });
  EXPECT_EQ(unread.damage.size(), 1U);
  EXPECT_EQ(last, 3U) << "so that a terminal's line ends";
}

}  // namespace
}  // namespace shearcell::test
