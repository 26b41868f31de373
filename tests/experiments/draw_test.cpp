// SPDX-License-Identifier: GPL-3.0-or-later
// A figure is a pure function of the checkpoints: made again it has the same bytes, and nothing is
// simulated for it.
#include "experiments/figures/draw.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "experiments/figures/collect.hpp"
#include "provenance/errors.hpp"
#include "provenance/sha256.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class DrawFigure : public testing::Test {
 protected:
  FigureSummary make(const std::string& name, std::size_t workers = 2) {
    FigureOptions options;
    options.folder = folder_.path() / name;
    options.workers = workers;
    return draw_figure(store_, *find_figure("S2"), options);
  }

  // File name -> bytes.
  std::map<std::string, std::string> contents(const std::string& name) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / name)) {
      files[entry.path().filename().string()] = read_bytes(entry.path());
    }
    return files;
  }

  double particle_steps() const {
    double sum = 0;
    for (const RunRecord& run : store_.runs()) sum += run.particle_steps;
    return sum;
  }

  TemporaryFolder folder_;
  Store store_{folder_.path() / "store", Access::create};
};

TEST_F(DrawFigure, ARunOfTwoExperimentsCountsOnce) {
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store_, text);
  compute(store_, "experiment: other" + text.substr(text.find('\n')));
  EXPECT_EQ(make("one").runs, 2U);
}

TEST_F(DrawFigure, EndsWhereTheExperimentsThatAskForItEnd) {
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store_, text);  // 2 cycles
  make("before");
  std::string longer = "experiment: other" + text.substr(text.find('\n'));
  longer.replace(longer.find("cycles: 2"), 9, "cycles: 4");
  longer.replace(longer.find("[S2]"), 4, "[S3]");
  compute(store_, longer);
  EXPECT_EQ(store_.runs().back().cycle, 4);
  make("after");
  EXPECT_EQ(contents("after"), contents("before")) << "no other experiment changes a figure";

  longer.replace(longer.find("[S3]"), 4, "[S2]");
  compute(store_, "# it asks for S2 too\n" + longer);
  EXPECT_EQ(make("both").checkpoints, 2U * 5U) << "to cycle 4";
}

TEST_F(DrawFigure, VerdictsAreWrittenAndRecorded) {
  compute(store_, tiny_manifest("", kBothFluids));
  const FigureSummary figure = make("one");
  ASSERT_EQ(figure.verdicts.size(), 3U);
  const nlohmann::json written =
      nlohmann::json::parse(read_bytes(folder_.path() / "one" / "S2.verdict.json"));
  EXPECT_EQ(written.at("figure"), "S2");
  EXPECT_EQ(written.at("verdict"), "undecided");
  EXPECT_EQ(written.at("claims").size(), 3U);
  EXPECT_TRUE(store_.figures().at(0).provenance.at("outputs").contains("S2.verdict.json"));
}

TEST_F(DrawFigure, TwiceGivesTheSameBytesAndSimulatesNothing) {
  compute(store_, tiny_manifest("", kBothFluids + "seeds: 2\n"));
  const double steps = particle_steps();
  ASSERT_GT(steps, 0);
  const FigureSummary first = make("one", 1);
  EXPECT_EQ(first.runs, 4U);
  EXPECT_EQ(first.checkpoints, 4U * 3U);
  EXPECT_TRUE(first.damage.empty());
  EXPECT_EQ(count_events(store_, "FigureGenerated"), 1U);

  const Head head = store_.head();
  make("two", 3);
  const auto files = contents("one");
  EXPECT_TRUE(files.contains("S2a.csv") && files.contains("S2b.csv"));
  EXPECT_TRUE(files.contains("S2.lineage.json"));
  EXPECT_EQ(files, contents("two"));
  EXPECT_EQ(store_.head().hash, head.hash) << "the second figure was recorded";
  EXPECT_EQ(particle_steps(), steps);

  // A header, and a row per variant and cycle.
  const std::string& csv = files.at("S2a.csv");
  std::printf("%s", csv.c_str());
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 3);
}

TEST_F(DrawFigure, TheLineageNamesInputsAndOutputs) {
  compute(store_, tiny_manifest("", kBothFluids));
  make("figures");
  const auto files = contents("figures");
  const auto lineage = nlohmann::json::parse(files.at("S2.lineage.json"));
  nlohmann::json recorded_facts = store_.figures().at(0).provenance;
  EXPECT_EQ(recorded_facts.erase("made"), 1U) << "who made it may change, and the file must not";
  EXPECT_EQ(lineage, recorded_facts);
  ASSERT_EQ(lineage.at("inputs").size(), 2U);
  for (const auto& input : lineage.at("inputs")) {
    std::vector<std::string> recorded;
    for (const CheckpointRecord& record : store_.checkpoints(input.at("run"))) {
      recorded.push_back(record.sha256);
    }
    EXPECT_EQ(recorded, input.at("checkpoints").get<std::vector<std::string>>());
  }
  EXPECT_EQ(lineage.at("outputs").at("S2a.csv"), sha256_hex(files.at("S2a.csv")));
  EXPECT_EQ(lineage.at("outputs").at("S2b.csv"), sha256_hex(files.at("S2b.csv")));
}

TEST_F(DrawFigure, LeavesOutADamagedCheckpointAndNamesIt) {
  compute(store_, tiny_manifest("", kBothFluids));
  const RunRecord run = runs_of_kind(store_, "shear").back();
  const CheckpointRecord record = store_.checkpoints(run.id).at(1);
  truncate_file(store_.folder() / record.file);
  const FigureSummary figure = make("figures");
  EXPECT_EQ(figure.checkpoints, 2U * 3U - 1U);
  ASSERT_EQ(figure.damage.size(), 1U);
  std::printf("%s\n", figure.damage[0].c_str());
  EXPECT_NE(figure.damage[0].find(record.file), std::string::npos);
  const auto files = contents("figures");
  EXPECT_EQ(files.at("S2.lineage.json").find(record.sha256), std::string::npos);
  const std::string& csv = files.at("S2a.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 3 - 1);
}

TEST_F(DrawFigure, ALongerRunMakesANewFigure) {
  compute(store_, tiny_manifest("", kBothFluids));
  make("short");
  compute(store_, tiny_manifest("", kBothFluids),
          ExpandOptions{.scale = {}, .cycles = 3, .seeds = {}});
  EXPECT_EQ(make("long").checkpoints, 2U * 4U);
  EXPECT_EQ(count_events(store_, "FigureGenerated"), 2U);
}

TEST_F(DrawFigure, TakesTheScaleThatIsAskedFor) {
  const std::string text = tiny_manifest(
      "", kBothFluids + "scales: {desk: {cycles: 1}, smoke: {grains: 250, cycles: 2}}\n");
  compute(store_, text, ExpandOptions{.scale = "smoke", .cycles = {}, .seeds = {}});
  compute(store_, text);
  EXPECT_EQ(make("last").scale, "desk");
  FigureOptions options;
  options.folder = folder_.path() / "smoke";
  options.scale = "smoke";
  const FigureSummary smoke = draw_figure(store_, *find_figure("S2"), options);
  EXPECT_EQ(smoke.scale, "smoke");
  EXPECT_EQ(smoke.checkpoints, 2U * 3U);
  options.scale = "paper";
  EXPECT_THROW(draw_figure(store_, *find_figure("S2"), options), NotFound);
}

TEST_F(DrawFigure, KnowsWhichFiguresTheStoreCanMake) {
  EXPECT_TRUE(figures_of_store(store_).figures.empty());
  EXPECT_THROW(make("none"), NotFound);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "none")) << "a folder for no figure";
  const Manifest manifest = parse_manifest(tiny_manifest(), "t");
  declare(store_, manifest, expand(manifest));
  const WantedFigures wanted = figures_of_store(store_);
  std::vector<std::string_view> names;
  for (const Figure* figure : wanted.figures) names.push_back(figure->name);
  EXPECT_EQ(names, (std::vector<std::string_view>{"table1", "S2"}));
  EXPECT_TRUE(wanted.unknown.empty());
}

// Registered by a program that knew other figures.
TEST_F(DrawFigure, NamesTheNearestFigureOfAnUnknownOne) {
  store_.register_manifest(
      "text", "x.yaml",
      {{"experiment", "x"}, {"question", ""}, {"figures", {"walss", "S2", "nothing like it"}}});
  const WantedFigures wanted = figures_of_store(store_);
  EXPECT_EQ(wanted.figures.size(), 2U);
  ASSERT_EQ(wanted.unknown.size(), 2U);
  EXPECT_EQ(wanted.unknown[0], "experiment x: there is no figure walss; did you mean walls?");
  EXPECT_NE(wanted.unknown[1].find("known are table1, S1"), std::string::npos);
  EXPECT_EQ(&figure_called("S2"), find_figure("S2"));
  EXPECT_THROW(figure_called("S99"), NotFound);
}

}  // namespace
}  // namespace shearcell
