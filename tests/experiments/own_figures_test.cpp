// SPDX-License-Identifier: GPL-3.0-or-later
// Plots and claims of a manifest, drawn from runs that several variants share or that are not
// computed yet.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "experiments/figures/collect.hpp"
#include "provenance/errors.hpp"
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
  EXPECT_EQ(newest_runs(select_runs(store_, {}), false).runs.size(), 12U) << "in a table";
  EXPECT_EQ(collect_runs(store_, {*find_figure("table1"), ""}, {}).runs.size(), 9U);
  draw("own", "both");
  const std::string csv = contents("own").at("both.csv");
  for (const char* row : {"\npressure_at=top,0,", "\npressure_at=top,9.81,",
                          "\npressure_at=moving_wall,0,", "\npressure_at=moving_wall,9.81,"}) {
    EXPECT_TRUE(has(csv, row)) << csv;
  }
  draw("own", "some");
  const auto verdict = nlohmann::json::parse(contents("own").at("some.verdict.json"));
  EXPECT_EQ(verdict.at("verdict"), "agrees");
  EXPECT_EQ(verdict.at("runs").size(), 2U) << "the variants that it compares";
  const std::string refusal = message_of<UsageError>([&] { draw("own", "none"); });
  EXPECT_TRUE(has(refusal, "are the same runs, so their difference is exactly zero")) << refusal;
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
  EXPECT_EQ(verdict.at("verdict"), "undecided");
  EXPECT_EQ(verdict.at("claims").at(0).at("note"), "no run with fluid=still is computed so far");
}

}  // namespace
}  // namespace shearcell::test
