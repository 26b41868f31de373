// SPDX-License-Identifier: GPL-3.0-or-later
// A figure is a pure function of the checkpoints: made again it has the same bytes, and nothing is
// simulated for it.
#include "experiments/figures/draw.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "experiments/figures/collect.hpp"
#include "experiments/figures/more_measures.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "protocols/rest.hpp"
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
    return draw_figure(store_, {*find_figure("S2"), "tiny"}, options);
  }

  // File name -> bytes.
  std::map<std::string, std::string> contents(const std::string& name) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / name / "tiny")) {
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

TEST_F(DrawFigure, RunsOfAnotherExperimentNeverEnter) {
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store_, text);  // 2 cycles
  make("before");
  std::string longer = "experiment: other" + text.substr(text.find('\n'));
  longer.replace(longer.find("cycles: 2"), 9, "cycles: 4");
  compute(store_, longer + "seeds: 2\n");
  EXPECT_EQ(store_.runs().back().cycle, 4);
  make("after");
  EXPECT_EQ(contents("after"), contents("before"));

  FigureOptions options;
  options.folder = folder_.path() / "after";
  const FigureSummary other = draw_figure(store_, {*find_figure("S2"), "other"}, options);
  EXPECT_EQ(other.runs, 4U) << "two of them are those of tiny, extended";
  EXPECT_EQ(other.checkpoints, 4U * 5U);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "after/other/S2a.csv"));
  std::vector<std::string> names;
  for (const FigureRecord& record : store_.figures()) names.push_back(record.name);
  EXPECT_EQ(names, (std::vector<std::string>{"other/S2", "tiny/S2"}));
}

// Variant and seed of the runs of tiny/S2; none of them twice.
std::set<std::pair<std::string, std::uint64_t>> distinct_runs(const CollectedRuns& collected) {
  std::set<std::pair<std::string, std::uint64_t>> found;
  for (const CollectedRun& run : collected.runs) {
    EXPECT_TRUE(found.emplace(run.membership.variant, run.membership.seed).second)
        << run.membership.variant << " seed " << run.membership.seed;
  }
  return found;
}

TEST_F(DrawFigure, TakesTheNewestVersionOfTheManifest) {
  const WantedFigure wanted{*find_figure("S2"), "tiny"};
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store_, text);
  const std::string other = tiny_manifest("  pressure_Pa: 700\n", kBothFluids + "seeds: 2\n");
  compute(store_, other);
  CollectedRuns newest = collect_runs(store_, wanted, {});
  EXPECT_EQ(distinct_runs(newest).size(), 4U);
  for (const CollectedRun& run : newest.runs) {
    EXPECT_EQ(run.run.resolved.at("parameters").at("pressure_Pa"), 700);
  }
  ASSERT_EQ(newest.notes.size(), 1U);
  std::printf("%s\n", newest.notes[0].c_str());
  EXPECT_NE(newest.notes[0].find("2 runs of another version"), std::string::npos);
  EXPECT_NE(newest.notes[0].find("fluid=cell, fluid=still"), std::string::npos);

  const CollectedRuns all = collect_runs(store_, wanted, {.scale = {}, .all_versions = true});
  EXPECT_EQ(distinct_runs(all).size(), 6U) << "older runs are variants of their own";

  compute(store_, text);
  EXPECT_EQ(distinct_runs(collect_runs(store_, wanted, {})).size(), 2U) << "run again, the newest";
  compute(store_, "# a comment\n" + text);
  EXPECT_EQ(distinct_runs(collect_runs(store_, wanted, {.scale = {}, .all_versions = true})).size(),
            6U)
      << "no run comes twice";
}

// Another version of the program may resolve one manifest to other runs.
TEST_F(DrawFigure, ASeedCountsOncePerVariant) {
  compute(store_, tiny_manifest("", kBothFluids));
  RunDeclaration again;
  again.id = std::string(64, 'a');
  again.kind = "shear";
  again.grains = 300;
  again.target_cycles = 2;
  again.membership = runs_of_kind(store_, "shear").front().memberships.front();
  store_.declare_run(again);
  const CollectedRuns collected = collect_runs(store_, {*find_figure("S2"), "tiny"}, {});
  EXPECT_EQ(distinct_runs(collected).size(), 2U);
  ASSERT_EQ(collected.notes.size(), 1U);
  EXPECT_NE(collected.notes[0].find("is left out"), std::string::npos) << collected.notes[0];
}

TEST_F(DrawFigure, PlotsAndClaimsOfAManifestAreFiguresOfItsExperiment) {
  compute(
      store_,
      tiny_manifest("", kBothFluids + "labels: {\"fluid=still\": water at rest}\n"
                                      "plots: [{name: overlap, y: mean_overlap_d, show: traces}]\n"
                                      "claims: [{name: same, compare: phi, at_cycle: 2, margin: 1,"
                                      " between: [{fluid: still}, {fluid: cell}]}]\n"));
  FigureOptions options;
  options.folder = folder_.path() / "own";
  for (const WantedFigure& wanted : wanted_figures(store_, {"overlap", "same", "S2"}).figures) {
    draw_figure(store_, wanted, options);
  }
  const auto files = contents("own");
  EXPECT_EQ(files.at("overlap.csv").substr(0, 33), "variant,seed,cycle,mean_overlap_d");
  EXPECT_NE(files.at("overlap.gp").find("title 'water at rest'"), std::string::npos);
  EXPECT_NE(files.at("S2a.gp").find("title 'water at rest'"), std::string::npos);
  EXPECT_NE(files.at("S2.caption.txt").find("Runs: fluid=cell: 1, water at rest: 1."),
            std::string::npos)
      << files.at("S2.caption.txt");
  const auto verdict = nlohmann::json::parse(files.at("same.verdict.json"));
  EXPECT_EQ(verdict.at("claims").at(0).at("claim"),
            "same: phi at cycle 2 is the same for fluid=still and fluid=cell");
  EXPECT_EQ(verdict.at("claims").at(0).at("note").get<std::string>().find("1 pairs"), 0U);
  EXPECT_TRUE(files.contains("same.lineage.json"));
  EXPECT_THROW(wanted_figures(store_, {"overlaps"}), NotFound);
}

// Two variants share a curve, which the label of neither names.
TEST_F(DrawFigure, NothingAveragesOverAnotherSweptParameter) {
  compute(store_,
          tiny_manifest("",
                        "sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, "
                        "0.08]}}\nplots: [{name: mean, y: phi, by: fluid}]\n"),
          {.scale = {}, .cycles = 1, .seeds = {}});
  try {
    draw_figure(store_, wanted_figures(store_, {"mean"}).figures.at(0), {});
    FAIL() << "it averaged over the amplitudes";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(),
                 "figure mean would average over the values of amplitude_rad that experiment tiny "
                 "sweeps; leave out its `by` for a curve of each variant");
  }
}

TEST_F(DrawFigure, APlotByAKeyNamesItsCurvesByTheLabelsOfThatKey) {
  compute(store_,
          tiny_manifest("",
                        "sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, "
                        "0.08]}}\nlabels: {\"fluid=still\": water at rest}\n"
                        "plots: [{name: mean, y: phi, x: amplitude_rad, by: fluid}]\n"),
          {.scale = {}, .cycles = 1, .seeds = {}});
  FigureOptions options;
  options.folder = folder_.path() / "own";
  draw_figure(store_, wanted_figures(store_, {"mean"}).figures.at(0), options);
  const auto files = contents("own");
  EXPECT_NE(files.at("mean.gp").find("title 'water at rest'"), std::string::npos)
      << files.at("mean.gp");
  EXPECT_NE(files.at("mean.gp").find("title 'fluid=cell'"), std::string::npos);
  EXPECT_NE(files.at("mean.csv").find("\nfluid=still,0.05,"), std::string::npos)
      << files.at("mean.csv");
}

TEST_F(DrawFigure, TheNoteOnMissingCheckpointsSaysWhichRunsCannotMakeThem) {
  compute(store_, tiny_manifest("", "checkpoints: {every_cycles: 2}\n"));
  compute(store_, tiny_manifest("", "checkpoints: {every_cycles: 1}\n"));
  const WantedFigure wanted{*find_figure("S2"), "tiny"};
  EXPECT_TRUE(collect_runs(store_, wanted, {}).notes.empty()) << "made in the second run";
  const RunRecord ours = runs_of_kind(store_, "shear").front();
  RunDeclaration other;
  other.id = std::string(64, 'b');
  other.kind = "shear";
  other.parent = ours.parent;
  other.resolved = ours.resolved;
  other.resolved["parameters"]["engine"] = "lammps";
  other.grains = ours.grains;
  other.target_cycles = 2;
  other.membership = ours.memberships.back();
  other.membership.variant = "engine=lammps";
  store_.declare_run(other);
  store_.start_run(other.id, {});
  for (const CheckpointRecord& record : store_.checkpoints(ours.id)) {
    if (record.cycle == 1) continue;
    Checkpoint checkpoint = store_.load_checkpoint(record);
    checkpoint.run = other.id;
    store_.record_checkpoint(other.id, checkpoint);
  }
  const std::vector<std::string> notes = collect_runs(store_, wanted, {}).notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(
      notes[0].find("1 checkpoints that the manifest asks for were never made (runs bbbbbbbb)"),
      std::string::npos)
      << notes[0];
  EXPECT_NE(notes[0].find("LAMMPS"), std::string::npos) << notes[0];
  EXPECT_EQ(notes[0].find("computes them"), std::string::npos) << notes[0];
}

TEST_F(DrawFigure, AnAverageOverAnotherParameterIsRefused) {
  compute(store_, tiny_manifest("", kBothFluids));
  FigureOptions options;
  options.folder = folder_.path() / "out";
  try {
    draw_figure(store_, {*find_figure("S5a"), "tiny"}, options);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("the values of fluid"), std::string::npos)
        << error.what();
  }
}

TEST_F(DrawFigure, PhiAtRestIsThatOfTheRestedPacking) {
  compute(store_, tiny_manifest("", "sweep: {grid: {protocol: [continuous, paused]}}\n"));
  for (const RunRecord& run : store_.runs()) {
    if (run.kind == "prepare") continue;
    const std::vector<CheckpointRecord> records = store_.checkpoints(run.id);
    const std::vector<double> phi = phi_at_rest(store_, records, {2, false, {}});
    ASSERT_EQ(phi.size(), 3U);
    EXPECT_TRUE(std::isnan(phi[0])) << "the packings of cycle 0 are the same";
    Checkpoint checkpoint = store_.load_checkpoint(records[2]);
    const double recorded = analyse(checkpoint).measures.phi;
    checkpoint.state =
        rested(checkpoint.cell, shear_scene(read_stage(run.resolved).parameters), checkpoint.state);
    EXPECT_EQ(phi[2], analyse(checkpoint).measures.phi);
    EXPECT_NE(phi[2], recorded);
    EXPECT_EQ(phi_at_rest(store_, records, {1, false, {}})[2], phi[2]) << "as kept";
  }
}

TEST_F(DrawFigure, VerdictsAreWrittenAndRecorded) {
  compute(store_, tiny_manifest("", kBothFluids));
  const FigureSummary figure = make("one");
  ASSERT_EQ(figure.verdicts.size(), 3U);
  const nlohmann::json written =
      nlohmann::json::parse(read_bytes(folder_.path() / "one/tiny/S2.verdict.json"));
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
  options.collect.scale = "smoke";
  const FigureSummary smoke = draw_figure(store_, {*find_figure("S2"), "tiny"}, options);
  EXPECT_EQ(smoke.scale, "smoke");
  EXPECT_EQ(smoke.checkpoints, 2U * 3U);
  options.collect.scale = "paper";
  EXPECT_THROW(draw_figure(store_, {*find_figure("S2"), "tiny"}, options), NotFound);
}

TEST_F(DrawFigure, KnowsWhichFiguresTheStoreCanMake) {
  EXPECT_TRUE(wanted_figures(store_).figures.empty());
  EXPECT_THROW(make("none"), NotFound);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "none")) << "a folder for no figure";
  const Manifest manifest = parse_manifest(tiny_manifest(), "t");
  declare(store_, manifest, expand(manifest));
  const WantedFigures wanted = wanted_figures(store_);
  std::vector<std::string> names;
  for (const WantedFigure& one : wanted.figures) names.push_back(one.path());
  EXPECT_EQ(names, (std::vector<std::string>{"table1", "tiny/S2"}));
  EXPECT_EQ(wanted_figures(store_, {"S4"}).figures.size(), 0U);
  EXPECT_EQ(wanted_figures(store_, {"S4"}, "tiny").figures.size(), 1U) << "asked for by name";
  EXPECT_THROW(wanted_figures(store_, {}, "tini"), NotFound);
  EXPECT_TRUE(wanted.unknown.empty());
}

// Registered by a program that knew other figures.
TEST_F(DrawFigure, NamesTheNearestFigureOfAnUnknownOne) {
  store_.register_manifest(
      "text", "x.yaml",
      {{"experiment", "x"}, {"question", ""}, {"figures", {"walss", "S2", "nothing like it"}}});
  const WantedFigures wanted = wanted_figures(store_);
  EXPECT_EQ(wanted.figures.size(), 2U);
  ASSERT_EQ(wanted.unknown.size(), 2U);
  EXPECT_EQ(wanted.unknown[0], "experiment x: there is no figure walss; did you mean walls?");
  EXPECT_NE(wanted.unknown[1].find("known are table1, S1"), std::string::npos);
  EXPECT_THROW(wanted_figures(store_, {"S99"}), NotFound);
}

}  // namespace
}  // namespace shearcell
