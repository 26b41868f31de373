// SPDX-License-Identifier: GPL-3.0-or-later
// A figure is a pure function of the checkpoints: drawn twice it has the same bytes, and nothing is
// simulated for it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <tuple>

#include "experiments/figures/collect.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "protocols/rest.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/sha256.hpp"
#include "tests/experiments/drawing.hpp"
#include "tests/support/text.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

class DrawFigure : public DrawingTest {
 protected:
  double particle_steps() const {
    double sum = 0;
    for (const Stage& run : store_.stages()) sum += run.particle_steps;
    return sum;
  }
};

TEST_F(DrawFigure, LeavesOutRunsOfOtherExperiments) {
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store_, text);  // 2 cycles
  draw("before");
  compute(store_, renamed(tiny_manifest("  cycles: 4\n", kBothFluids + "seeds: 2\n"), "other"));
  EXPECT_EQ(store_.stages().back().cycle, 4);
  draw("after");
  EXPECT_EQ(contents("after"), contents("before"));

  const ComputedFigure other = draw("after", {*find_figure("S2"), "other"});
  EXPECT_EQ(other.runs, 4U) << "two of them are those of tiny, extended";
  EXPECT_EQ(other.checkpoints, 4U * 5U);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "after/other/base/S2a.csv"));
  std::vector<std::string> names;
  for (const FigureRecord& record : store_.figures()) names.push_back(record.name);
  EXPECT_EQ(names, (std::vector<std::string>{"other/base/S2", "tiny/base/S2"}));
}

// Variant and seed of the runs of tiny/S2, each once.
std::set<std::pair<std::string, std::uint64_t>> distinct_runs(const CollectedRuns& collected) {
  std::set<std::pair<std::string, std::uint64_t>> found;
  for (const FrameRun& run : collected.runs) {
    EXPECT_TRUE(found.emplace(run.place.variant, run.place.seed).second)
        << run.place.variant << " seed " << run.place.seed;
  }
  return found;
}

TEST_F(DrawFigure, UsesTheNewestVersionOfTheManifest) {
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store_, text);
  const std::string other = tiny_manifest("  pressure_Pa: 700\n", kBothFluids + "seeds: 2\n");
  compute(store_, other);
  CollectedRuns newest = collect_runs(store_, kS2, {});
  EXPECT_EQ(distinct_runs(newest).size(), 4U);
  for (const FrameRun& run : newest.runs) {
    EXPECT_EQ(run.stage.resolved.at("parameters").at("pressure_Pa"), 700);
  }
  ASSERT_EQ(newest.notes.size(), 1U);
  std::printf("%s\n", newest.notes[0].c_str());
  EXPECT_TRUE(has(newest.notes[0], "2 runs of manifest version"));
  EXPECT_TRUE(has(newest.notes[0], "fluid=cell, fluid=still"));

  compute(store_, text);
  EXPECT_EQ(distinct_runs(collect_runs(store_, kS2, {})).size(), 2U) << "run again, the newest";
  compute(store_, "# a comment\n" + text);
  EXPECT_EQ(distinct_runs(collect_runs(store_, kS2, {})).size(), 2U) << "no run comes twice";
}

// Bootstraps draw from the runs in their order, so it is part of what a figure's bytes depend on.
TEST_F(DrawFigure, TheOrderOfRunsDoesNotDependOnTheirDeclaration) {
  const std::string text = tiny_manifest("", kBothFluids + "seeds: 2\n");
  compute(store_, text, {.cycles = 1, .variants = {"fluid=still"}});
  compute(store_, text, {.cycles = 1});
  std::string order;
  for (const shearcell::Run& run : newest_runs(select_runs(store_, {})).runs)
    order += run.place.variant + std::to_string(run.place.seed) + " ";
  EXPECT_EQ(order, "fluid=cell1 fluid=cell2 fluid=still1 fluid=still2 ");
}

TEST_F(DrawFigure, EditingAManifestForOneScaleKeepsTheRunsOfOtherScales) {
  const std::string scales = "scales: {short: {cycles: 1}, long: {cycles: 2}}\n";
  compute(store_, tiny_manifest("", kBothFluids + scales), {.scale = "long"});
  compute(store_, tiny_manifest("  pressure_Pa: 700\n", scales), {.scale = "short"});
  EXPECT_EQ(collect_runs(store_, kS2, {}).scale, "short");
  EXPECT_EQ(distinct_runs(collect_runs(store_, kS2, {.scales = {"long"}})).size(), 2U);
  EXPECT_EQ(newest_runs(select_runs(store_, {})).runs.size(), 3U) << "in a table";
}

TEST_F(DrawFigure, AFilterDoesNotSelectAnOlderVersion) {
  compute(store_, tiny_manifest("", kBothFluids), {.cycles = 1});
  compute(store_, tiny_manifest("  pressure_Pa: 700\n"), {.cycles = 1});
  const NewestRuns cells = newest_runs(select_runs(store_, {.variants = {"fluid=cell"}}));
  EXPECT_TRUE(cells.runs.empty());
  ASSERT_EQ(cells.notes.size(), 1U);
  EXPECT_TRUE(has(cells.notes[0], "left out: 1 run of manifest version"));
  EXPECT_THROW(collect_runs(store_, kS2, {.variants = {"fluid=cell"}}), NotFound);
}

// Another version of the program may resolve one manifest to other runs.
TEST_F(DrawFigure, ASeedCountsOncePerVariant) {
  compute(store_, tiny_manifest("", kBothFluids));
  Stage again = declaration_of(sheared(store_));
  again.id = std::string(64, 'a');
  store_.declare_stage(again);
  const CollectedRuns collected = collect_runs(store_, kS2, {});
  EXPECT_EQ(distinct_runs(collected).size(), 1U);
  ASSERT_EQ(collected.notes.size(), 2U);
  EXPECT_TRUE(has(collected.notes[0], "is left out"));
  EXPECT_TRUE(has(collected.notes[1], "left out: 1 run without a checkpoint yet"));
  EXPECT_EQ(newest_runs(select_runs(store_, {})).runs.size(), 2U) << "in a table";
}

TEST_F(DrawFigure, PlotsAndClaimsOfAManifestAreFiguresOfItsExperiment) {
  compute(
      store_,
      tiny_manifest("", kBothFluids + "labels: {\"fluid=still\": water at rest}\n"
                                      "plots: [{name: overlap, y: mean_overlap_d, show: traces}]\n"
                                      "claims: [{name: same, compare: phi, at_cycle: 2, margin: 1,"
                                      " between: [{fluid: still}, {fluid: cell}]}]\n"));
  for (const char* name : {"overlap", "same", "S2"}) draw("own", name);
  const auto files = contents("own");
  EXPECT_EQ(files.at("overlap.csv").substr(0, 33), "variant,seed,cycle,mean_overlap_d");
  EXPECT_TRUE(has(files.at("overlap.gp"), "title 'water at rest'"));
  EXPECT_TRUE(has(files.at("S2a.gp"), "title 'water at rest'"));
  EXPECT_TRUE(has(files.at("S2.caption.txt"), "Runs: 1 each of fluid=cell; water at rest."));
  const auto verdict = nlohmann::json::parse(files.at("same.verdict.json"));
  EXPECT_EQ(verdict.at("claims").at(0).at("claim"),
            "same: phi at cycle 2 is the same for water at rest and fluid=cell");
  EXPECT_EQ(
      verdict.at("claims").at(0).at("note").get<std::string>().find("1 pair of runs that shares"),
      0U);
  EXPECT_TRUE(files.contains("same.lineage.json"));
  EXPECT_THROW(wanted_figures(store_, {"overlaps"}), NotFound);
}

TEST_F(DrawFigure, APrimaryClaimIsMarkedAtItsScale) {
  const std::string claim =
      "claims: [{name: same, compare: phi, at_cycle: 1, margin: 1, statement: \"phi is equal\", "
      "between: [{fluid: still}, {fluid: cell}]}]\n";
  for (const bool primary : {false, true}) {
    compute(store_,
            tiny_manifest("", kBothFluids + claim + (primary ? "primary: [phi is equal]\n" : "")),
            {.cycles = 1});
    draw("own", "same");
    const auto found = nlohmann::json::parse(contents("own").at("same.verdict.json")).at("claims");
    EXPECT_EQ(found.at(0).value("primary", false), primary);
  }
}

// Records leave these keys out at the values of older runs.
TEST_F(DrawFigure, AClaimMayNameAValueThatTheRecordLeavesOut) {
  compute(store_,
          tiny_manifest("",
                        "sweep: {grid: {pressure_at: [top, moving_wall]}}\n"
                        "claims: [{name: same, compare: phi, at_cycle: 1, margin: 1,"
                        " between: [{pressure_at: top, wall_grain_draw: 0},"
                        " {pressure_at: moving_wall, engine: shearcell}]}]\n"),
          {.cycles = 1});
  draw("own", "same");
  const auto verdict = nlohmann::json::parse(contents("own").at("same.verdict.json"));
  const auto note = verdict.at("claims").at(0).at("note").get<std::string>();
  EXPECT_TRUE(note.starts_with("the two sides have 1 and 1 independent runs")) << note;
}

// The manifest states how many seeds a claim is decided by, whatever the command ran.
TEST_F(DrawFigure, AClaimIsDecidedWhenTheRunsOfAllSeedsHaveEnded) {
  const std::string manifest = tiny_manifest(
      "",
      "seeds: 4\nlooks: [3, 4]\nprimary: [own.dense]\n"
      "claims: [{id: own.dense, compare: phi, at_cycle: 1, margin: 0.5, of: {fluid: still},"
      " published: {value: 0.6, source: a guess}}]\n");
  const auto claim = [&](std::uint64_t seeds) {
    compute(store_, manifest, {.cycles = 1, .seeds = seeds});
    draw("own", "own");
    return nlohmann::json::parse(contents("own").at("own.verdict.json")).at("claims").at(0);
  };
  const nlohmann::json early = claim(2);
  EXPECT_EQ(early.at("verdict"), "undecided");
  EXPECT_EQ(early.at("look"), 0);
  EXPECT_TRUE(has(early.at("note").get<std::string>(),
                  "2 of 4 seeds have ended; the next look (interim analysis) is at 3 seeds"));
  EXPECT_TRUE(early.at("primary"));
  const nlohmann::json decided = claim(3);
  EXPECT_EQ(decided.at("verdict"), "agrees");
  EXPECT_EQ(decided.at("look"), 3);
  EXPECT_EQ(decided.at("looks"), (std::vector{3, 4}));
  EXPECT_EQ(claim(4).at("estimate"), decided.at("estimate")) << "the first verdict is final";
  // A selection of seeds is not a planned look.
  const WantedFigure own = wanted_figures(store_, {"own"}).figures.at(0);
  RunSelection few;
  few.seeds = {1, 2};
  const Verdict part = draw("part", own, few).verdicts.at(0);
  EXPECT_EQ(part.ruling, Ruling::undecided);
  EXPECT_EQ(part.runs, 2U);
  EXPECT_TRUE(has(part.note, "2 of 4 seeds")) << part.note;
  few.seeds = {1, 2, 3};
  EXPECT_EQ(draw("look", own, few).verdicts.at(0).ruling, Ruling::agrees);
}

// Figures that are computed in C++ have one look, at all runs.
TEST_F(DrawFigure, AComputedFigureGivesNoVerdictBeforeAllRunsHaveEnded) {
  const std::string manifest = tiny_manifest("", "seeds: 2\n");
  for (const std::uint64_t seeds : {1, 2}) {
    compute(store_, manifest, {.cycles = 1, .seeds = seeds});
    const Verdict verdict = draw("own", {*find_figure("S7"), "tiny"}).verdicts.at(0);
    EXPECT_EQ(has(verdict.note, "1 planned run has not ended, or is not selected"), seeds == 1)
        << verdict.note;
  }
}

// Two variants share a curve, which the label of neither names.
TEST_F(DrawFigure, CurvesByAKeyHaveItsLabelsAndPoolNoOtherKey) {
  compute(store_,
          tiny_manifest("",
                        "sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, 0.08]}}\n"
                        "labels: {\"fluid=still\": water at rest}\n"
                        "plots: [{name: mean, y: phi, by: fluid},"
                        " {name: each, y: phi, x: amplitude_rad, by: fluid}]\n"),
          {.cycles = 1});
  const auto refusal = [&](const WantedFigure& wanted) {
    return message_of<UsageError>([&] { draw("out", wanted); });
  };
  EXPECT_EQ(refusal(wanted_figures(store_, {"mean"}).figures.at(0)),
            "figure mean would average over the values of amplitude_rad that experiment tiny "
            "sweeps; remove the key `by` of the plot to draw a curve for each variant");
  const std::string of_supplement = refusal({*find_figure("C"), "tiny"});
  EXPECT_TRUE(has(of_supplement, "the values of fluid"));
  draw("own", "each");
  const auto files = contents("own");
  EXPECT_TRUE(has(files.at("each.gp"), "title 'water at rest'"));
  EXPECT_TRUE(has(files.at("each.gp"), "title 'fluid=cell'"));
  EXPECT_TRUE(has(files.at("each.csv"), "\nfluid=still,0.05,"));
}

TEST_F(DrawFigure, AGroupedFigureDoesNotPoolVersions) {
  const std::string sweep = "sweep: {grid: {amplitude_rad: [0.05, 0.08]}}\n";
  for (const char* base : {"  pressure_Pa: 700\n", ""}) {
    compute(store_, tiny_manifest(base, sweep), {.cycles = 1});
  }
  const WantedFigure onset{*find_figure("S5a"), "tiny"};
  EXPECT_NO_THROW(draw("newest", onset));
  EXPECT_EQ(distinct_runs(collect_runs(store_, onset, {})).size(), 2U);
}

// The manifest asks for cycles 0 and 2 of these cycles.
TEST_F(DrawFigure, MissesNoCheckpointThatTheManifestDoesNotAskFor) {
  compute(store_, tiny_manifest("", "checkpoints: {every_cycles: 2}\n"), {.cycles = 4});
  WantedFigure begun = kS2;
  begun.figure.within = {{0, 3}};
  const CollectedRuns collected = collect_runs(store_, begun, {});
  EXPECT_EQ(collected.notes, std::vector<std::string>());
  EXPECT_EQ(collected.runs.at(0).checkpoints.size(), 2U);
}

TEST_F(DrawFigure, NamesRunsWhoseMissingCheckpointsCannotBeComputed) {
  compute(store_, tiny_manifest("", "checkpoints: {every_cycles: 2}\n"));
  compute(store_, tiny_manifest("", "checkpoints: {every_cycles: 1}\n"));
  EXPECT_TRUE(collect_runs(store_, kS2, {}).notes.empty()) << "made in the second run";
  const Stage ours = sheared(store_);
  Stage other = declaration_of(ours);
  other.id = std::string(64, 'b');
  other.resolved["parameters"]["engine"] = "lammps";
  other.memberships = {ours.memberships.back()};
  other.memberships[0].place.variant = "engine=lammps";
  store_.declare_stage(other);
  store_.start_stage(other.id, {});
  for (const CheckpointRecord& record : store_.checkpoints(ours.id)) {
    if (record.cycle == 1) continue;
    Checkpoint checkpoint = store_.load_checkpoint(record);
    checkpoint.run = other.id;
    store_.record_checkpoint(other.id, checkpoint);
  }
  const std::vector<std::string> notes = collect_runs(store_, kS2, {}).notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(has(notes[0], "missing: 1 checkpoint that the manifest asks for (runs bbbbbbbb)"));
  EXPECT_TRUE(has(notes[0], "LAMMPS"));
  EXPECT_FALSE(has(notes[0], "computes them"));
}

TEST_F(DrawFigure, PhiAtRestIsThatOfTheRestedPacking) {
  compute(store_, tiny_manifest("", "sweep: {grid: {protocol: [continuous, paused]}}\n"));
  for (const Stage& run : store_.stages()) {
    if (run.kind == "prepare") continue;
    const std::vector<CheckpointRecord> records = store_.checkpoints(run.id);
    const auto at_rest = [&](std::size_t workers) {
      const std::vector<std::string> names = {"scalars", "rest"};
      std::vector<double> phi;
      const MeasureOptions how{.workers = workers};
      for (const CheckpointMeasures& one : measured(store_, records, names, how).checkpoints) {
        phi.push_back(one.measures.number("phi_at_rest"));
      }
      return phi;
    };
    const std::vector<double> phi = at_rest(2);
    ASSERT_EQ(phi.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      Checkpoint checkpoint = store_.load_checkpoint(records[k]);
      const double recorded = analyse(checkpoint).measures.phi;
      checkpoint.state = rested(checkpoint.cell, shear_scene(read_stage(run.resolved).parameters),
                                checkpoint.state, 0.1);
      EXPECT_EQ(phi[k], analyse(checkpoint).measures.phi);
      EXPECT_NE(phi[k], recorded);
    }
    EXPECT_EQ(at_rest(1)[2], phi[2]) << "as kept";
    const std::vector<std::string> names = {"scalars", "rest"};
    const MeasureOptions one_cycle{.simulated = {{1, 1}}};
    const auto some = measured(store_, records, names, one_cycle).checkpoints;
    EXPECT_EQ(some[1].measures.number("phi_at_rest"), phi[1]);
    for (const std::size_t other : {0U, 2U}) {
      EXPECT_TRUE(std::isnan(some[other].measures.number("phi_at_rest"))) << "kept, not asked for";
      EXPECT_TRUE(some[other].lacking.empty());
    }
  }
}

/// The `plots` and `claims` of a manifest in experiments/.
std::string plots_and_claims(const std::string& experiment) {
  const std::string text = read_bytes(std::filesystem::path(SHEARCELL_TEST_DATA) / ".." / ".." /
                                      "experiments" / (experiment + ".yaml"));
  const std::size_t begin = text.find("\nplots:") + 1;
  return text.substr(begin, text.find("\nbase:") + 1 - begin);
}

// A copy of drag.yaml under another name, and a manifest that lists the figure, as older ones do.
TEST_F(DrawFigure, IsTheSameStatedAndListed) {
  const std::string listing = tiny_manifest("", kBothFluids + "seeds: 3\n");
  compute(store_, listing);
  draw("listed");
  const std::size_t begin = listing.find("question:"), end = listing.find("base:");
  std::string stated = listing;
  stated.replace(begin, end - begin,
                 "question: " + find_figure("S2")->title + "\n" + plots_and_claims("drag"));
  compute(store_, stated);
  const WantedFigures wanted = wanted_figures(store_, {"S2"});
  ASSERT_EQ(wanted.figures.size(), 1U) << "the stated one";
  draw("stated", wanted.figures[0]);
  auto listed = contents("listed"), own = contents("stated");
  for (auto* files : {&listed, &own}) files->erase("S2.lineage.json");
  EXPECT_EQ(listed.size(), 11U);
  for (const auto& [name, bytes] : listed) EXPECT_EQ(bytes, own.at(name)) << name;
}

TEST_F(DrawFigure, GivesTheSameBytesTwiceAndSimulatesNothing) {
  compute(store_, tiny_manifest("", kBothFluids + "seeds: 2\n"));
  const double steps = particle_steps();
  ASSERT_GT(steps, 0);
  FigureOptions options;
  const ComputedFigure first = draw("one", kS2, options);
  EXPECT_EQ(first.runs, 4U);
  EXPECT_EQ(first.checkpoints, 4U * 3U);
  EXPECT_TRUE(first.damage.empty());
  EXPECT_EQ(count_events(store_, "FigureGenerated"), 1U);

  const Head head = store_.head();
  options.workers = 3;
  draw("two", kS2, options);
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

TEST_F(DrawFigure, VerdictsAndLineageAreWrittenAndRecorded) {
  compute(store_, tiny_manifest("", kBothFluids));
  EXPECT_EQ(draw("figures").verdicts.size(), 3U);
  const auto files = contents("figures");
  const auto verdict = nlohmann::json::parse(files.at("S2.verdict.json"));
  EXPECT_EQ(verdict.at("figure"), "S2");
  EXPECT_EQ(verdict.at("verdict"), "3 undecided");
  EXPECT_TRUE(
      files.at("S2.verdict.csv").starts_with("id,claim,group,seed,packing,value,missing,cycle\n"));
  const auto entered = folder_.path() / "figures/tiny/base/S2.verdict.csv";
  std::ofstream(entered) << "claim,group\n";  // of an earlier version of the program
  draw("figures");
  EXPECT_EQ(contents("figures"), files);
  std::ofstream(entered) << "group,claim\n";
  EXPECT_THROW(draw("figures"), NotOurs);
  std::filesystem::remove(entered);
  EXPECT_EQ(verdict.at("runs"), (nlohmann::json{{"fluid=still", 1}, {"fluid=cell", 1}}));
  EXPECT_EQ(verdict.at("claims").size(), 3U);
  const auto lineage = nlohmann::json::parse(files.at("S2.lineage.json"));
  nlohmann::json recorded_facts = store_.figures().at(0).provenance;
  EXPECT_EQ(recorded_facts.erase("made"), 1U) << "who made it may change, and the file must not";
  EXPECT_EQ(lineage, recorded_facts);
  ASSERT_EQ(lineage.at("inputs").size(), 2U);
  for (const auto& input : lineage.at("inputs")) {
    const std::vector<CheckpointRecord> records = store_.checkpoints(input.at("run"));
    ASSERT_EQ(records.size(), 3U);
    EXPECT_EQ(input.at("cycles"), nlohmann::json::parse("[[0, 2, 1]]"));
    EXPECT_EQ(input.at("state_hash"), records[2].state_hash);
    EXPECT_EQ(input.at("states_sha256"),
              sha256_hex(records[0].state_hash + "\n" + records[1].state_hash + "\n" +
                         records[2].state_hash + "\n"));
  }
  for (const char* name : {"S2a.csv", "S2b.csv", "S2.verdict.json"}) {
    EXPECT_EQ(lineage.at("outputs").at(name), sha256_hex(files.at(name))) << name;
  }
}

/// A program of this name stands before the real one on PATH; its script may call "$real".
class FakeProgram {
 public:
  FakeProgram(const std::string& name, const std::string& script)
      : path_("PATH", folder_.path().string() + ":" + std::getenv("PATH")) {
    const auto real = find_program(name);
    const std::string text = "#!/bin/sh\nreal=" + real.value_or("none").string() + "\n" + script;
    write_script(folder_.path() / name, text);
  }

 private:
  const TemporaryFolder folder_;
  const Variable path_;
};

// Tables and their drawings are recorded together, or not at all.
TEST_F(DrawFigure, RecordsNothingIfADrawingFails) {
  if (!find_program("gnuplot") || !find_program("rsvg-convert")) GTEST_SKIP();
  compute(store_, tiny_manifest("", kBothFluids));
  const std::string half =
      "sed \"s/^set output '.*/set output 'whole'/\" $2 > own.gp\n"
      "\"$real\" -d own.gp; head -c 4000 whole > ${2%.gp}.svg\n";
  const std::string second = "case $2 in S2b.gp) exit 3;; *) exec \"$real\" \"$@\";; esac\n";
  for (const auto& [name, script, failed] :
       {std::tuple("gnuplot", half, "gnuplot could not draw S2a.svg: it wrote 4000 bytes"),
        {"gnuplot", std::string("kill -9 $$\n"), "S2a.svg: it was ended by signal 9"},
        {"gnuplot", second, "gnuplot could not draw S2b.svg: it ended with code 3"},
        {"rsvg-convert", std::string("\"$real\" \"$@\" | head -c 3000\n"),
         "rsvg-convert could not draw S2a.pdf: it wrote 3000 bytes"},
        {"rsvg-convert", std::string("echo no >&2; exit 1\n"), "it ended with code 1:\nno"}}) {
    const FakeProgram fake(name, script);
    const ComputedFigure summary = draw("out");
    ASSERT_FALSE(summary.undrawn.empty()) << script;
    EXPECT_TRUE(has(summary.undrawn.front(), failed)) << summary.undrawn.front();
    EXPECT_EQ(summary.undrawn.size(), script == second ? 1U : 2U);
    EXPECT_EQ(count_events(store_, "FigureGenerated"), 0U);
    EXPECT_TRUE(contents("out").contains("S2a.csv")) << "the data stay";
  }
  EXPECT_TRUE(draw("out").undrawn.empty());
  EXPECT_EQ(count_events(store_, "FigureGenerated"), 1U);
}

TEST_F(DrawFigure, WithoutGnuplotRecordsTheTables) {
  compute(store_, tiny_manifest("", kBothFluids));
  const Variable nowhere("PATH", "/nonexistent");
  EXPECT_EQ(draw("out").undrawn.size(), 2U);
  ASSERT_EQ(count_events(store_, "FigureGenerated"), 1U);
  const nlohmann::json outputs = store_.figures().at(0).provenance.at("outputs");
  EXPECT_TRUE(outputs.contains("S2a.csv"));
  EXPECT_FALSE(outputs.contains("S2a.svg"));
}

TEST_F(DrawFigure, DeletesVerdictAndCaptionOfAnOlderFigure) {
  compute(store_, tiny_manifest("", kBothFluids), {.cycles = 1});
  draw("out");
  ASSERT_TRUE(contents("out").contains("S2.verdict.json"));
  ASSERT_TRUE(contents("out").contains("S2.caption.txt"));
  WantedFigure bare = kS2;
  bare.figure.make = [](const Frame&) { return FigureResult(); };
  draw("out", bare);
  EXPECT_FALSE(contents("out").contains("S2.verdict.json"));
  EXPECT_FALSE(contents("out").contains("S2.caption.txt"));
}

TEST_F(DrawFigure, NamesTablesWithoutValues) {
  compute(store_, tiny_manifest(), {.cycles = 1});
  WantedFigure made_up = kS2;
  made_up.figure.make = [](const Frame&) {
    Table none{.name = "none", .columns = {"x", "y"}};
    none.chart.series = {{.variant = "a"}, {.points = {{.x = 1, .y = 1}}}};
    Table unknown = none, known = none;
    unknown.name = "unknown", known.name = "known";
    unknown.chart.series[0].points = {{1.0, std::nan("")}};
    known.chart.series[0].points = {{1.0, 2.0}};
    return FigureResult{{none, unknown, known}, {}};
  };
  const ComputedFigure figure = compute_figure(store_, made_up, {});
  EXPECT_EQ(figure.empty, (std::vector<std::string>{"none", "unknown"}));
  EXPECT_EQ(figure.why_empty,
            "Nothing is drawn in none, unknown: no run has the values to be shown.");
  EXPECT_TRUE(has(figure.caption, figure.why_empty));
}

TEST_F(DrawFigure, NamesVariantsInTheOrderOfTheirValuesAndRunsWithoutInteriorGrains) {
  compute(store_, tiny_manifest("  grains: 60\n",
                                "sweep: {grid: {pressure_Pa: [700, 1200]}}\n"
                                "plots: [{name: own, y: phi, x: cycle}]\n"));
  const std::string caption = draw("out", "own").caption;
  for (const char* part : {"Runs: 1 each of P=700 Pa; P=1200 Pa.", "Nothing is drawn in own:",
                           "Notes: 2 of 2 runs had no interior grains"}) {
    EXPECT_TRUE(has(caption, part)) << caption;
  }
}

TEST_F(DrawFigure, SaysWhyAFigureOfLaterCyclesIsEmpty) {
  compute(
      store_,
      tiny_manifest("", "plots: [{name: late, y: phi, x: cycle, cycles: [7, 9], show: traces}]\n"));
  const ComputedFigure late = draw("out", "late");
  EXPECT_EQ(late.why_empty, "Nothing is drawn: no run has a checkpoint at the cycles to be shown.");
  EXPECT_TRUE(has(late.notes.at(0), "left out: 1 run without a checkpoint in cycles 7 to 9"));
}

// A store of an earlier version lists figures and states no plots.
TEST_F(DrawFigure, SaysWhosePlotsDrewAFigureThatTheManifestOnlyLists) {
  compute(store_, tiny_manifest("", "plots: [{name: own, y: phi, x: cycle}]\n"));
  draw("out", "S2");
  draw("out", "own");
  const auto plots = [&](const FigureRecord& record) {
    return figure_lineage(store_, record).plots;
  };
  const std::vector<FigureRecord> records = figure_records(store_);
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(plots(records[0]), "drawn by the plots of shearcell 0.1.0; the manifest lists S2 only");
  EXPECT_EQ(plots(records[1]), "");
  EXPECT_EQ(to_json(figure_lineage(store_, records[0])).at("plots"), plots(records[0]));
  EXPECT_TRUE(has(contents("out").at("S2.lineage.json"), plots(records[0])));
}

// Another program may register a newer version while figures are drawn.
TEST_F(DrawFigure, TakesAllFiguresOfACommandFromOneReadingOfTheManifests) {
  compute(store_, tiny_manifest("", "seeds: 2\nplots: [{name: own, y: phi, x: cycle}]\n"));
  const std::vector<WantedFigure> wanted = wanted_figures(store_).figures;
  ASSERT_EQ(wanted.size(), 3U) << "S2, own and table1";
  const Manifest longer = parse_manifest(tiny_manifest("", "seeds: 5\n"), "tiny.yaml");
  store_.register_manifest(longer.text, "tiny.yaml",
                           {{"experiment", "tiny"}, {"question", ""}, {"figures", {"S2"}}});
  EXPECT_EQ(collect_runs(store_, wanted[0], {}).seeds.size(), 2U);
  EXPECT_EQ(collect_runs(store_, wanted[1], {}).seeds.size(), 2U);
  EXPECT_EQ(wanted[0].manifests, wanted[1].manifests);
}

TEST_F(DrawFigure, LeavesOutADamagedCheckpointAndNamesIt) {
  compute(store_, tiny_manifest("", kBothFluids));
  const Stage run = runs_of_kind(store_, "shear").back();
  const CheckpointRecord record = store_.checkpoints(run.id).at(1);
  truncate_file(store_.folder() / record.file);
  const ComputedFigure figure = draw("figures");
  EXPECT_EQ(figure.checkpoints, 2U * 3U - 1U);
  ASSERT_EQ(figure.damage.size(), 1U);
  std::printf("%s\n", figure.damage.begin()->c_str());
  EXPECT_TRUE(has(*figure.damage.begin(), record.file));
  const auto files = contents("figures");
  std::vector<CheckpointRecord> left = store_.checkpoints(run.id);
  std::erase_if(left, [&](const CheckpointRecord& c) { return c.sha256 == record.sha256; });
  EXPECT_TRUE(has(files.at("S2.lineage.json"), states_of(left).sha256));
  const std::string& csv = files.at("S2a.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 3 - 1);
}

TEST_F(DrawFigure, UsesTheRequestedScale) {
  const std::string text = tiny_manifest(
      "", kBothFluids + "scales: {desk: {cycles: 1}, smoke: {grains: 250, cycles: 2}}\n");
  compute(store_, text, {.scale = "smoke"});
  compute(store_, text);
  EXPECT_EQ(draw("last").scale, "desk");
  const ComputedFigure smoke = draw("smoke", kS2, RunSelection{.scales = {"smoke"}});
  EXPECT_EQ(smoke.scale, "smoke");
  EXPECT_EQ(smoke.checkpoints, 2U * 3U);
  EXPECT_THROW(draw("paper", kS2, RunSelection{.scales = {"paper"}}), NotFound);
}

TEST_F(DrawFigure, UsesTheSelectedRuns) {
  compute(store_, tiny_manifest("", kBothFluids + "seeds: 3\n"));
  RunSelection runs{.variants = {"fluid=cell"}, .seeds = {1, 3}};
  EXPECT_EQ(draw("part", kS2, runs).runs, 2U);
  EXPECT_TRUE(has(contents("part").at("S2.caption.txt"), "Runs: fluid=cell: 2."));
  runs.variants = {"fluid=none"};
  EXPECT_THROW(draw("none", kS2, runs), NotFound);
}

TEST_F(DrawFigure, ListsTheFiguresThatTheStoreCanMake) {
  EXPECT_TRUE(wanted_figures(store_).figures.empty());
  EXPECT_THROW(draw("none"), NotFound);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "none")) << "a folder for no figure";
  declared(store_, tiny_manifest());
  const WantedFigures wanted = wanted_figures(store_);
  std::vector<std::string> names;
  for (const WantedFigure& one : wanted.figures) names.push_back(one.path());
  EXPECT_EQ(names, (std::vector<std::string>{"tiny/S2", "table1"}));
  EXPECT_EQ(wanted_figures(store_, {"S4"}).figures.size(), 0U);
  EXPECT_EQ(wanted_figures(store_, {"S4"}, {"tiny"}).figures.size(), 1U) << "asked for by name";
  EXPECT_THROW(wanted_figures(store_, {}, {"tini"}), NotFound);
  EXPECT_TRUE(wanted.unknown.empty());
}

// Registered by a program that knew other figures.
TEST_F(DrawFigure, SuggestsTheNearestFigureName) {
  store_.register_manifest(
      "text", "x.yaml",
      {{"experiment", "x"}, {"question", ""}, {"figures", {"walss", "S2", "nothing like it"}}});
  const WantedFigures wanted = wanted_figures(store_);
  EXPECT_EQ(wanted.figures.size(), 2U);
  ASSERT_EQ(wanted.unknown.size(), 2U);
  EXPECT_EQ(wanted.unknown[0], "experiment x: there is no figure walss; did you mean walls?");
  EXPECT_TRUE(has(wanted.unknown[1], "known are table1, S7"));
  EXPECT_THROW(wanted_figures(store_, {"S99"}), NotFound);
}

}  // namespace
}  // namespace shearcell::test
