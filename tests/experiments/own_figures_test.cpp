// SPDX-License-Identifier: GPL-3.0-or-later
// Plots and claims of a manifest, drawn from runs that several variants share or that are not
// computed yet.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "experiments/figures/collect.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/errors.hpp"
#include "provenance/lineage.hpp"
#include "tests/experiments/drawing.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

class OwnFigures : public DrawingTest {};

// Without gravity, pressure_at has no effect: three of the four variants are different runs.
TEST_F(OwnFigures, ShowEveryVariantOfARun) {
  const auto between = [](const std::string& name, const std::string& second) {
    return "  - {name: " + name +
           ", compare: phi, at_cycle: 1, margin: 1, between: [{gravity_m_per_s2: 0, pressure_at: "
           "moving_wall}, {" +
           second + "}]}\n";
  };
  compute(store_,
          tiny_manifest("",
                        "seeds: 3\nsweep: {grid: {gravity_m_per_s2: [0, 9.81], pressure_at: [top, "
                        "moving_wall]}}\nplots: [{name: both, y: phi, x: gravity_m_per_s2, by: "
                        "pressure_at}]\nclaims:\n" +
                            between("none", "gravity_m_per_s2: 0, pressure_at: top") +
                            between("some", "gravity_m_per_s2: 9.81, pressure_at: moving_wall")),
          {.cycles = 1});
  EXPECT_EQ(runs_of_kind(store_, "shear").size(), 9U);
  EXPECT_EQ(newest_runs(select_runs(store_, {})).runs.size(), 12U) << "in a table";
  EXPECT_EQ(collect_runs(store_, {*find_figure("table1"), ""}, {}).runs.size(), 9U);
  draw("own", "both");
  const std::string csv = contents("own").at("both.csv");
  for (const char* row : {"\npressure_at=top,0,", "\npressure_at=top,9.81,",
                          "\npressure_at=moving_wall,0,", "\npressure_at=moving_wall,9.81,"}) {
    EXPECT_TRUE(has(csv, row)) << csv;
  }
  draw("own", "some");
  const auto verdict = nlohmann::json::parse(contents("own").at("some.verdict.json"));
  EXPECT_EQ(verdict.at("verdict"), "1 agrees");
  EXPECT_EQ(verdict.at("runs").size(), 2U) << "the variants that it compares";
  const std::string refusal = message_of<UsageError>([&] { draw("own", "none"); });
  EXPECT_TRUE(has(refusal, "select the same runs, so the difference is exactly zero")) << refusal;
}

TEST_F(OwnFigures, SayWhichCheckpointIsMissing) {
  const std::string text =
      tiny_manifest("", kBothFluids +
                            "checkpoints: {every_cycles: 2}\nplots: [{name: odd, y: phi, x: "
                            "drag_kg_per_s, at_cycle: 1}, {name: even, y: phi, x: drag_kg_per_s, "
                            "at_cycle: 2}]\n");
  declared(store_, text, {.cycles = 2});
  const auto notes = [&](const char* name) {
    return collect_runs(store_, wanted_figures(store_, {name}).figures.at(0), {}).notes;
  };
  const std::string which = ": fluid=cell seed 1, fluid=still seed 1";
  EXPECT_EQ(notes("odd"),
            std::vector<std::string>{"left out: 2 runs without a checkpoint at cycle 1" + which});
  EXPECT_EQ(notes("even"), std::vector<std::string>{
                               "left out: 2 runs without a checkpoint at cycle 2 yet" + which});
}

TEST_F(OwnFigures, AClaimOnRunsThatAreNotComputedIsUndecided) {
  const std::string text =
      tiny_manifest("", kBothFluids +
                            "claims: [{name: same, compare: phi, at_cycle: 1, margin: 1,"
                            " between: [{fluid: still}, {fluid: cell}]}]\n");
  compute(store_, text, {.cycles = 1, .variants = {"fluid=cell"}});
  declared(store_, text, {.cycles = 1});
  draw("own", "same");
  const auto verdict = nlohmann::json::parse(contents("own").at("same.verdict.json"));
  EXPECT_EQ(verdict.at("verdict"), "1 undecided");
  EXPECT_EQ(verdict.at("claims").at(0).at("note"),
            "no run with fluid=still has a checkpoint of cycle 1");
}

// Table I is of the supplement, and a user's own experiments are not.
TEST_F(OwnFigures, ComeWithoutTable1UnlessItIsNamed) {
  std::string text = tiny_manifest("", "plots: [{name: own, y: phi}]\n");
  text.erase(text.find("figures: [S2]\n"), 14);
  declared(store_, text, {.cycles = 0});
  const auto names = [&](const std::vector<std::string>& wanted) {
    std::vector<std::string> found;
    for (const WantedFigure& one : wanted_figures(store_, wanted).figures) {
      found.push_back(one.figure.name);
    }
    return found;
  };
  const std::vector<std::string> own = names({});
  EXPECT_EQ(std::ranges::count(own, "own"), 1);
  EXPECT_EQ(std::ranges::count(own, "table1"), 0);
  EXPECT_EQ(names({"table1"}), std::vector<std::string>{"table1"});
}

TEST_F(OwnFigures, AClaimSaysThatItsRunsAreNotSelected) {
  compute(store_, tiny_manifest("", kBothFluids +
                                        "claims: [{name: same, compare: phi, at_cycle: 1, margin: "
                                        "1, between: [{fluid: still}, {fluid: cell}]}]\n"));
  for (const char* figure : {"same", "S2"}) {
    const WantedFigure wanted = wanted_figures(store_, {figure}).figures.at(0);
    FigureOptions options;
    options.runs.variants = {"fluid=cell"};
    for (const Verdict& verdict : compute_figure(store_, wanted, options).verdicts) {
      EXPECT_TRUE(verdict.note.starts_with("only runs with fluid=cell are selected: "))
          << verdict.note;
    }
  }
}

// Both computed cycle 1 first and were extended; what the packing took is not in it.
TEST_F(OwnFigures, OfErrorAgainstCoreTime) {
  const std::string text = tiny_manifest(
      "",
      "seeds: 3\nsweep: {grid: {steps_per_cycle: [20000, 40000]}}\nplots: [{name: cost, y: phi, "
      "minus: {steps_per_cycle: 40000}, x: core_time_s, show: rms, log: xy, at_cycle: 2}]\n");
  compute(store_, text, {.cycles = 1});
  std::map<std::string, double> first;
  for (const Stage& run : runs_of_kind(store_, "shear")) {
    first[run.id] = computing_time(store_, run.id, 9).core_seconds;
  }
  compute(store_, text, {.cycles = 2});
  double mean = 0;
  for (const Stage& run : runs_of_kind(store_, "shear")) {
    const double both = computing_time(store_, run.id, 9).core_seconds;
    EXPECT_EQ(computing_time(store_, run.id, 1).core_seconds, first.at(run.id));
    EXPECT_GT(first.at(run.id), 0);
    EXPECT_GT(both, first.at(run.id));
    EXPECT_LT(both, 1.2 * run.wall_seconds) << "one thread";
    if (run.resolved.at("parameters").at("steps_per_cycle") == 20000) mean += both / 3;
  }
  draw("own", "cost");
  const std::string csv = contents("own").at("cost.csv");
  EXPECT_TRUE(csv.starts_with(
      "variant,core_time_s,phi_difference_rms,phi_difference_standard_error,runs,cycle\n"))
      << csv;
  EXPECT_EQ(std::ranges::count(csv, '\n'), 2) << "one variant";
  EXPECT_TRUE(has(csv, fmt::format("all,{:.9g},", mean))) << csv << mean;
  const Table table = run_table(store_, {}, RowPer::run, {}).table;
  for (const auto& row : table.rows) {
    EXPECT_GT(std::get<double>(row.at(table.place("core_time_s"))), 0);
  }
}

// Its scalars are cached for S2; its stress is unknown and not zero.
TEST_F(OwnFigures, LeaveOutWhatAPrunedCheckpointCannotGive) {
  compute(store_, tiny_manifest("", "plots: [{name: xy, y: stress_xy_Pa}]\n"));
  draw("own");
  const CheckpointRecord middle = store_.checkpoints(sheared(store_).id).at(1);
  store_.prune({middle});
  EXPECT_EQ(draw("own", "xy").pruned.size(), 1U);
  const std::string without = contents("own").at("xy.csv");
  EXPECT_FALSE(has(without, "\nbase,1,0,")) << without;
  EXPECT_TRUE(has(without, "\nbase,1,,")) << without;
  EXPECT_TRUE(has(to_csv(run_table(store_, {}, RowPer::checkpoint, {}).table), ",,,,,,"))
      << "a table too";
  regenerate_checkpoint(store_, middle);
  draw("own", "xy");
  EXPECT_FALSE(has(contents("own").at("xy.csv"), "\nbase,1,,"));
}

// The version that was run last is the newest one, whichever store is merged first.
TEST_F(OwnFigures, AreThoseOfTheVersionThatWasRunLast) {
  std::vector<std::filesystem::path> stores;
  for (const char* name : {"first", "last"}) {
    stores.push_back(folder_.path() / name);
    Store store(stores.back(), Access::create);
    compute(store, tiny_manifest("", "plots: [{name: " + std::string(name) + ", y: phi}]\n"),
            {.cycles = 0});
  }
  for (const auto& order : {stores, {stores[1], stores[0]}}) {
    Store merged(folder_.path() / ("of_" + order[0].filename().string()), Access::create);
    merged.merge(order);
    const auto figures = wanted_figures(merged).figures;
    EXPECT_TRUE(std::ranges::any_of(
        figures, [](const WantedFigure& wanted) { return wanted.figure.name == "last"; }));
    const std::size_t events = merged.events().size();
    declared(merged, tiny_manifest("", "plots: [{name: last, y: phi}]\n"), {.cycles = 0});
    EXPECT_EQ(merged.events().size(), events) << "it is registered as the newest";
  }
}

TEST_F(OwnFigures, AClaimSaysWhatItsRunsLack) {
  const std::string claim =
      "claims: [{name: same, compare: phi, cycles: [2, 3], margin: 1,"
      " between: [{fluid: still}, {fluid: cell}]}]\n";
  compute(store_,
          tiny_manifest("  cycles: 4\n",
                        kBothFluids + "seeds: 3\ncheckpoints: {every_cycles: 2}\n" + claim));
  const ComputedFigure summary = draw("own", "same");
  EXPECT_TRUE(has(summary.verdicts.at(0).note, "6 of 6 runs lack a checkpoint of cycles 2 to 3"))
      << summary.verdicts.at(0).note;
}

// One variant has ended, and of the other pair of variants nothing is computed.
TEST_F(OwnFigures, AClaimSaysNothingOfOtherRuns) {
  const std::string text = tiny_manifest(
      "",
      "sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, 0.1]}}\nseeds: 3\n"
      "claims: [{name: same, compare: phi, at_cycle: 1, margin: 1, between: [{fluid: still, "
      "amplitude_rad: 0.05}, {fluid: cell, amplitude_rad: 0.05}]}]\n");
  compute(store_, text, {.cycles = 1, .variants = {"amplitude_rad=0.05"}});
  declared(store_, text, {.cycles = 3});  // they go on, beyond what the claim takes
  EXPECT_EQ(draw("own", "same").notes, std::vector<std::string>());
}

// A 3 x 3 sweep against the frequency in Hz, a figure with two panels, panels of a parameter, and a
// claim with a published number (experiments/RECIPES.md).
TEST_F(OwnFigures, OfASweepAgainstFrequencyWithPublishedNumbers) {
  compute(store_, tiny_manifest("  steps_per_cycle: auto\n  cycles: 1\n", R"(
sweep: {grid: {period_s: [0.25, 0.5, 1], amplitude_rad: [0.05, 0.0833, 0.1]}}
seeds: 3
labels: {"amplitude_rad=0.1": "a large amplitude"}
plots:
  - name: phi_of_f
    figure: drive
    y: phi
    x: 1/period_s
    xlabel: "driving frequency $f$ [Hz]"
    by: amplitude_rad
    series: {0.05: {label: "$A_{min}$", colour: purple, marker: open_circle}}
    published:
      - {label: random close packing, value: 0.637, error: 0.001, source: a journal}
  - {name: pressure, figure: drive, y: contact_pressure_Pa/pressure_Pa, x: 1/period_s, by: amplitude_rad}
  - {name: by_period, y: contacts_per_grain, by: amplitude_rad, panel: period_s}
claims:
  - name: close
    figure: drive
    compare: phi
    at_cycle: 1
    of: {period_s: 1, amplitude_rad: 0.1}
    published: {value: 0.637, error: 0.001, source: a journal}
    margin: 0.1
)"));
  draw("own", "drive");
  draw("own", "by_period");
  const auto files = contents("own");
  const std::string& csv = files.at("phi_of_f.csv");
  EXPECT_TRUE(csv.starts_with("variant,1/period_s,phi_mean,phi_standard_error,runs,cycle\n"))
      << csv;
  EXPECT_EQ(std::ranges::count(csv, '\n'), 10) << "nine variants";
  for (const char* row : {"\namplitude_rad=0.05,1,", "\namplitude_rad=0.1,4,"}) {
    EXPECT_TRUE(has(csv, row)) << csv;
  }
  const std::string& script = files.at("phi_of_f.gp");
  for (const char* part :
       {"set xlabel 'driving frequency {/:Italic f} [Hz]'",
        "lc rgb '#cc79a7' lw 1.2 pt 6 ps 0.4 title '{/:Italic A}_{min}'",
        "title 'a large amplitude'", "title 'random close packing 0.637 ± 0.001'",
        "first 0.636 to graph 1"}) {
    EXPECT_TRUE(has(script, part)) << script;
  }
  const std::string& caption = files.at("drive.caption.txt");
  for (const char* part : {"(a) volume fraction ϕ against driving frequency f [Hz].",
                           "(b) contact_pressure_Pa/pressure_Pa against 1/period_s.", "At cycle 1",
                           "Published: random close packing 0.637 ± 0.001: a journal.",
                           "Runs: 3 each of 9 variants."}) {
    EXPECT_TRUE(has(caption, part)) << caption;
  }
  EXPECT_TRUE(has(files.at("pressure.csv"), "(contact_pressure_Pa/pressure_Pa)_mean"));
  EXPECT_TRUE(files.contains("by_period_3.csv") && !files.contains("by_period_4.csv"));
  EXPECT_TRUE(has(files.at("by_period_1.gp"), "set title 'T=0.25 s'"));
  const auto verdict = nlohmann::json::parse(files.at("drive.verdict.json"));
  EXPECT_EQ(verdict.at("verdict"), "1 agrees");
  EXPECT_EQ(verdict.at("claims").at(0).at("claim"),
            "close: phi at cycle 1 is as published, 0.637 ± 0.001 (a journal), for a large "
            "amplitude, T=1 s");
}

}  // namespace
}  // namespace shearcell::test
