// SPDX-License-Identifier: GPL-3.0-or-later
// A manifest expands into its runs, in its order, each once.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tests/experiments/plan_of.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

Manifest drag() {
  return load_manifest(fs::path(SHEARCELL_TEST_DATA) / ".." / ".." / "experiments" / "drag.yaml");
}

Manifest parse(const std::string& text) {
  return parse_manifest(text, "test.yaml");
}

Plan at(const Manifest& manifest, const std::string& scale) {
  return expand(manifest, {.scale = scale});
}

Strings variants(const Plan& plan) {
  Strings names;
  for (const PlannedRun& run : plan.runs) names.push_back(run.place.variant);
  return names;
}

std::string message(const Manifest& manifest, const ExpandOptions& options) {
  return message_of<ManifestError>([&] { expand(manifest, options); });
}

TEST(Drag, ComparesTheFluidsOnTheSamePackings) {
  const std::vector<PlannedRun> runs = at(drag(), "smoke").runs;
  ASSERT_EQ(runs.size(), 4U);
  EXPECT_EQ(expand(drag()).scale, "desk") << "by default";
  EXPECT_EQ(runs[0].ask.checkpoint_every, 1U) << "by default";
  EXPECT_EQ(variants({{}, "", {}, runs, {}}),
            (Strings{"fluid=still", "fluid=still", "fluid=cell", "fluid=cell"}));
  EXPECT_EQ(runs[0].place.seed, 1U);
  EXPECT_EQ(runs[1].place.seed, 2U);
  EXPECT_EQ(runs[2].place.swept, (nlohmann::json{{"fluid", "cell"}}));
  EXPECT_EQ(runs[2].parameters.fluid, Fluid::cell);
  EXPECT_EQ(runs[0].prepare->id, runs[2].prepare->id);
  EXPECT_EQ(runs[1].prepare->id, runs[3].prepare->id);
  EXPECT_NE(runs[0].prepare->id, runs[1].prepare->id);
  std::set<std::string> shear;
  for (const PlannedRun& run : runs) {
    EXPECT_EQ(run.stage.parent, run.prepare->id);
    shear.insert(run.stage.id);
  }
  EXPECT_EQ(shear.size(), 4U);
}

TEST(Expand, WithoutSweepThereIsOneVariant) {
  const Plan plan = expand(parse("experiment: one\nbase: {}\n"));
  ASSERT_EQ(plan.runs.size(), 1U);
  EXPECT_EQ(plan.scale, "");
  EXPECT_EQ(plan.runs[0].place.variant, "base");
  EXPECT_EQ(plan.runs[0].place.swept, nlohmann::json::object());
  EXPECT_EQ(plan.runs[0].parameters, Parameters{});
}

TEST(Expand, FirstGridAxisVariesSlowestAndTheZipFastest) {
  const Plan plan = expand(parse(R"(
experiment: product
base: {}
sweep:
  zip: {amplitude_rad: [0.05, 0.1], period_s: [2, 3]}
  grid: {walls: [rough, smooth], gravity_m_per_s2: [9.81, 0]}
)"));
  EXPECT_EQ(variants(plan),
            (Strings{"walls=rough,gravity_m_per_s2=9.81,amplitude_rad=0.05,period_s=2",
                     "walls=rough,gravity_m_per_s2=9.81,amplitude_rad=0.1,period_s=3",
                     "walls=rough,gravity_m_per_s2=0,amplitude_rad=0.05,period_s=2",
                     "walls=rough,gravity_m_per_s2=0,amplitude_rad=0.1,period_s=3",
                     "walls=smooth,gravity_m_per_s2=9.81,amplitude_rad=0.05,period_s=2",
                     "walls=smooth,gravity_m_per_s2=9.81,amplitude_rad=0.1,period_s=3",
                     "walls=smooth,gravity_m_per_s2=0,amplitude_rad=0.05,period_s=2",
                     "walls=smooth,gravity_m_per_s2=0,amplitude_rad=0.1,period_s=3"}));
  EXPECT_EQ(plan.runs[7].parameters.walls, WallTexture::smooth);
  EXPECT_EQ(plan.runs[7].parameters.gravity_m_per_s2, 0);
  EXPECT_EQ(plan.runs[7].parameters.amplitude_rad, 0.1);
  EXPECT_EQ(plan.runs[7].parameters.period_s, 3);
}

Strings ids(const std::string& rest) {
  Strings found;
  for (const PlannedRun& run : plan_of("grains: 600", rest).runs) {
    found.push_back(run.place.variant + " " + run.stage.id);
  }
  return found;
}

TEST(Expand, ARangeIsTheListOfItsValues) {
  for (const auto& [range, list] :
       {std::pair{"amplitude_rad: {from: 0.01, to: 0.1, count: 10}",
                  "amplitude_rad: [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1]"},
        {"period_s: {to: 2.1, from: 2.7, count: 3, spacing: linear}", "period_s: [2.7, 2.4, 2.1]"},
        {"pressure_Pa: {from: 300, to: 4800, count: 5, spacing: log}",
         "pressure_Pa: [300, 600, 1200, 2400, 4800]"},
        {"pressure_Pa: {from: 300, to: 3000, count: 5, spacing: log}",
         "pressure_Pa: [300, 533.483823012, 948.683298051, 1687.02397557, 3000]"},
        {"grains: {from: 500, to: 8000, count: 4, spacing: log}",
         "grains: [500, 1260, 3175, 8000]"},
        {"drag_kg_per_s: {from: 0, to: 1.28e-3, count: 2}", "drag_kg_per_s: [0, 1.28e-3]"}}) {
    for (const char* kind : {"grid", "zip"}) {
      const auto sweep = [&](const char* values) {
        return ids(fmt::format("sweep: {{{}: {{{}}}}}\n", kind, values));
      };
      EXPECT_EQ(sweep(range), sweep(list)) << kind;
    }
  }
  EXPECT_EQ(ids("sweep: {zip: {amplitude_rad: {from: 0.05, to: 0.1, count: 2}, cycles: [3, 2]}}\n"),
            ids("sweep: {zip: {amplitude_rad: [0.05, 0.1], cycles: [3, 2]}}\n"));
}

TEST(Expand, ARangeOfSeedsIsTheListOfItsSeeds) {
  for (const auto& [range, list] : {std::pair{"2001-2003", "[2001, 2002, 2003]"},
                                    {"[1-3, 9]", "[1, 2, 3, 9]"},
                                    {"[9, 4 - 6]", "[9, 4, 5, 6]"},
                                    {"7-7", "[7]"},
                                    {"1-6", "6"}}) {
    EXPECT_EQ(ids(fmt::format("seeds: {}\n", range)), ids(fmt::format("seeds: {}\n", list)));
  }
  EXPECT_EQ(message(parse("experiment: a\nseeds: 1-6\n"), {.seeds = 7}),
            message(parse("experiment: a\nseeds: [1, 2, 3, 4, 5, 6]\n"), {.seeds = 7}));
}

TEST(Manifest, AQuestionMayHaveSeveralLines) {
  EXPECT_EQ(parse("experiment: a\nquestion: |\n  Does the fluid\n  matter?\n\n").question,
            "Does the fluid matter?");
}

TEST(Parse, ReadsAWholeNumberInAnyNotation) {
  for (const char* grains : {"600", "6e2", "600.0", "+600"}) {
    EXPECT_EQ(plan_of(std::string("grains: ") + grains).runs.front().stage.id,
              plan_of("grains: 600").runs.front().stage.id);
  }
}

TEST(Expand, WarnsOfGrainsWithAnotherUnit) {
  const auto warning = [](const std::string& base) {
    const Strings warnings = plan_of(base).warnings;
    return warnings.empty() ? "" : warnings.front();
  };
  EXPECT_TRUE(has(warning("diameter_m: 3"),
                  "grains of 3 m and 2e-05 kg have a density of 1.4e-06 kg/m^3. Check the units"));
  EXPECT_TRUE(has(warning("mass_kg: 20"), "Check the units of diameter_m [m] and mass_kg [kg]."));
  EXPECT_FALSE(has(warning("diameter_m: 1, mass_kg: 1"), "density")) << "reduced units";
}

TEST(Expand, ScalesOverrideBaseSeedsSweepAndCadence) {
  const Manifest manifest = parse(R"(
experiment: sizes
base: {cycles: 100, amplitude_rad: 0.05}
sweep: {grid: {grains: [5200, 7900, 11400]}}
seeds: [11, 7]
checkpoints: {every_cycles: 5}
scales:
  smoke: {cycles: 3, seeds: 1, sweep: {grid: {grains: [300, 600]}}, checkpoints: {every_cycles: 1}}
  paper: {}
)");
  const Plan smoke = at(manifest, "smoke");
  EXPECT_EQ(variants(smoke), (Strings{"grains=300", "grains=600"}));
  EXPECT_EQ(smoke.runs[0].ask.target_cycles, 3U);
  EXPECT_EQ(smoke.runs[0].place.seed, 1U);
  EXPECT_EQ(smoke.runs[0].ask.checkpoint_every, 1U);
  EXPECT_EQ(smoke.runs[0].parameters.amplitude_rad, 0.05);
  const Plan paper = at(manifest, "paper");
  ASSERT_EQ(paper.runs.size(), 6U);
  EXPECT_EQ(paper.runs[0].place.seed, 11U);
  EXPECT_EQ(paper.runs[1].place.seed, 7U);
  EXPECT_EQ(paper.runs[0].ask.checkpoint_every, 5U);
}

TEST(Expand, OptionsOverrideTheManifest) {
  ExpandOptions options{.scale = "smoke", .cycles = 9, .seeds = 3};
  const Plan plan = expand(drag(), options);
  ASSERT_EQ(plan.runs.size(), 6U);
  EXPECT_EQ(plan.runs[0].ask.target_cycles, 9U);
  EXPECT_EQ(plan.runs[2].place.seed, 3U);
  const Manifest listed = parse("experiment: a\nbase: {}\nseeds: [11, 7, 5]\n");
  EXPECT_EQ(expand(listed, {.seeds = 2}).runs[1].place.seed, 7U);
}

// Small amplitudes take more cycles: a zip gives each variant its own length, which names no
// variant.
TEST(Expand, AZipHasALengthForEachVariant) {
  const Manifest manifest =
      parse("experiment: a\nsweep: {zip: {amplitude_rad: [0.05, 0.1], cycles: [300, 20]}}\n");
  const Plan plan = expand(manifest);
  EXPECT_EQ(variants(plan), (Strings{"amplitude_rad=0.05", "amplitude_rad=0.1"}));
  EXPECT_EQ(plan.runs[0].ask.target_cycles, 300U);
  EXPECT_EQ(plan.runs[1].ask.target_cycles, 20U);
  EXPECT_EQ(plan.runs[1].place.swept, (nlohmann::json{{"amplitude_rad", 0.1}}));
  EXPECT_EQ(plan.runs[1].stage.id,
            expand(parse("experiment: a\nbase: {amplitude_rad: 0.1}\n")).runs[0].stage.id);
  for (const PlannedRun& run : expand(manifest, {.cycles = 7}).runs)
    EXPECT_EQ(run.ask.target_cycles, 7U);
}

// Runs that take longer may be fewer, in the same figure.
TEST(Expand, AZipHasANumberOfSeedsForEachVariant) {
  const std::string text =
      "experiment: a\nseeds: [7, 8, 9]\n"
      "sweep: {zip: {amplitude_rad: [0.05, 0.1], seeds: [1, 3]}}\n";
  const Manifest manifest = parse(text);
  const Plan plan = expand(manifest);
  std::vector<std::uint64_t> seeds;
  for (const PlannedRun& run : plan.runs) seeds.push_back(run.place.seed);
  EXPECT_EQ(seeds, (std::vector<std::uint64_t>{7, 7, 8, 9}));
  EXPECT_EQ(plan.runs[0].place.swept, (nlohmann::json{{"amplitude_rad", 0.05}}));
  EXPECT_EQ(expand(manifest, {.seeds = 2}).runs.size(), 4U) << "of each variant";
  EXPECT_EQ(expand(manifest, {.only_seeds = {8}}).runs.size(), 1U);
  EXPECT_EQ(message_of<ManifestError>([&] { parse(text + "scales: {desk: {seeds: 2}}\n"); }),
            "test.yaml:3:54: seeds: are too few for `looks` or for the sweep (got 3). Write "
            "`seeds: 3`, or list this many seeds.");
}

TEST(Expand, TakesOnlyTheRequestedVariants) {
  const Manifest manifest =
      parse("experiment: a\nsweep: {grid: {amplitude_rad: [0.05, 0.1], fluid: [still, cell]}}\n");
  EXPECT_EQ(variants(expand(manifest, {.variants = {"fluid=cell", "amplitude_rad=0.1"}})),
            Strings{"amplitude_rad=0.1,fluid=cell"});
  EXPECT_EQ(variants(expand(manifest, {.variants = {"fluid=cell,amplitude_rad=0.1"}})),
            Strings{"amplitude_rad=0.1,fluid=cell"});
  EXPECT_EQ(variants(expand(manifest, {.variants = {"fluid=cell, A=0.1 rad"}})),
            Strings{"amplitude_rad=0.1,fluid=cell"})
      << "as figures and tables name it";
  EXPECT_EQ(variants(expand(
                manifest, {.variants = {"amplitude_rad=0.05", "amplitude_rad=0.1", "fluid=cell"}})),
            (Strings{"amplitude_rad=0.05,fluid=cell", "amplitude_rad=0.1,fluid=cell"}));
  EXPECT_EQ(message(manifest, {.variants = {"fluid=cell", "amplitude_rad=0.2"}}),
            "test.yaml: variant: no variant has these values (got amplitude_rad=0.2). The variants "
            "are amplitude_rad=0.05,fluid=still; amplitude_rad=0.05,fluid=cell; "
            "amplitude_rad=0.1,fluid=still; amplitude_rad=0.1,fluid=cell.");
}

TEST(Expand, RejectsOptionsThatDoNotFit) {
  const Manifest manifest =
      parse("experiment: a\nbase: {}\nseeds: [4]\nscales: {smoke: {cycles: 1}, paper: {}}\n");
  EXPECT_EQ(
      message(manifest, {}),
      "test.yaml: scale: is unknown (got desk). The manifest has smoke, paper; --scale selects "
      "one of them.");
  EXPECT_EQ(message(manifest, {.scale = "smok"}),
            "test.yaml: scale: is unknown, the nearest is smoke (got smok). The manifest has "
            "smoke, paper; --scale selects one of them.");
  EXPECT_EQ(message(manifest, {.scale = "smoke", .seeds = 2}),
            "test.yaml: seeds: the manifest lists only 1 seed (got 2). List more seeds, or write "
            "only their number, as in `seeds: 6`.");
  EXPECT_NE(message(manifest, {.scale = "smoke", .seeds = 0}), "");
  EXPECT_NE(message(manifest, {.scale = "smoke", .cycles = 1'000'000'000}), "");
  EXPECT_NE(message(drag(), {.scale = "smoke", .seeds = 9'999}), "");
  EXPECT_NE(message(parse("experiment: a\nbase: {}\n"), {.scale = "desk"}), "");
}

TEST(Expand, WarnsOfACellThatThePressureCannotLift) {
  const auto warnings = [](const std::string& base) { return plan_of(base).warnings; };
  const std::string lifting = "pressure_at: moving_wall, grains: 30000";
  EXPECT_TRUE(warnings("pressure_at: moving_wall, grains: 18200").empty());
  ASSERT_EQ(warnings(lifting).size(), 1U);
  EXPECT_TRUE(has(warnings(lifting)[0], "cannot lift") &&
              has(warnings(lifting)[0], "Use `pressure_at: top`"));
  EXPECT_TRUE(warnings("grains: 30000").empty()) << "loaded with the weight as well";
  EXPECT_TRUE(warnings("grains: 30000, gravity_m_per_s2: 0").empty());
  EXPECT_TRUE(warnings("grains: 30000, moving_wall: top").empty());
}

TEST(Expand, WarnsOfADragTooSmallToSettle) {
  const auto warnings = [](const std::string& base) { return plan_of(base).warnings; };
  for (const auto& [base, says] :
       {std::pair{"drag_kg_per_s: 0",
                  "with drag_kg_per_s 0 and wall_drag_grains_per_d2_s 1000 the grains come to rest "
                  "too late"},
        {"drag_kg_per_s: 2e-6", "come to rest only after about 1.8e+02 s"}}) {
    ASSERT_EQ(warnings(base).size(), 1U) << base;
    EXPECT_TRUE(has(warnings(base)[0], says) &&
                has(warnings(base)[0], "settling fails at settle_time_limit_s (60 s)"));
  }
  EXPECT_TRUE(warnings("drag_kg_per_s: 2e-5").empty());
}

TEST(Expand, WarnsOnceOfWhatSeveralVariantsHave) {
  const auto warnings = [](const std::string& amplitudes) {
    return plan_of("grains: 600, steps_per_cycle: 20000",
                   fmt::format("sweep: {{grid: {{amplitude_rad: [{}]}}}}\n", amplitudes))
        .warnings;
  };
  const auto two = warnings("0.05, 0.1");
  ASSERT_EQ(two.size(), 1U);
  EXPECT_TRUE(has(two[0], ": variants amplitude_rad=0.05, amplitude_rad=0.1: steps_per_cycle: "));
  const auto ten = warnings(".01, .02, .03, .04, .05, .06, .07, .08, .09, .1");
  ASSERT_EQ(ten.size(), 1U);
  EXPECT_TRUE(has(ten[0], "amplitude_rad=0.08 and 2 more: steps_per_cycle: "));
}

TEST(Expand, SelectsVariantsByValueNotBySpelling) {
  const Manifest manifest =
      parse("experiment: e\nbase: {grains: 600}\nsweep: {grid: {drag_kg_per_s: [1.28e-2, 0.1]}}\n");
  for (const char* wanted : {"drag_kg_per_s=1.28e-2", "drag_kg_per_s=0.01280",
                             " drag_kg_per_s = .0128 ", "drag_kg_per_s=0.0128000001"}) {
    const Plan plan = expand(manifest, {.variants = {wanted}});
    ASSERT_FALSE(plan.runs.empty());
    for (const PlannedRun& run : plan.runs) EXPECT_EQ(run.place.variant, "drag_kg_per_s=0.0128");
  }
  EXPECT_THROW(expand(manifest, {.variants = {"drag_kg_per_s=0.0129"}}), ManifestError);
}

TEST(Expand, WarnsOfPlotsAndClaimsThatCannotBeMade) {
  const auto warnings = [](const std::string& own) {
    return plan_of("cycles: 3",
                   "seeds: 3\n"
                   "sweep: {grid: {fluid: [still, cell], walls: [rough, smooth]}}\n" +
                       own)
        .warnings;
  };
  const auto claim = [&](const std::string& sides, int cycle) {
    return warnings(
        fmt::format("claims: [{{name: same, compare: phi, margin: 1, at_cycle: {}, "
                    "between: [{}]}}]\n",
                    cycle, sides));
  };
  const std::string sides = "{fluid: still, walls: rough}, {fluid: cell, walls: rough}";
  EXPECT_TRUE(claim(sides, 3).empty());
  ASSERT_EQ(claim(sides, 4).size(), 1U);
  EXPECT_TRUE(has(claim(sides, 4)[0],
                  "claim same: runs lack a checkpoint at cycle 4, so phi has no value"));
  ASSERT_EQ(claim("{fluid: still}, {fluid: cell, walls: rough}", 3).size(), 1U);
  EXPECT_TRUE(has(claim("{fluid: still}, {fluid: cell, walls: rough}", 3)[0],
                  "2 variants have fluid=still"));
  for (const auto& [plot, problem] :
       {std::pair("y: phi, by: fluid", "average over the values of walls"),
        std::pair("y: phi, x: drag_kg_per_s, at_cycle: 50", "runs lack a checkpoint at cycle 50"),
        std::pair("y: stress_xy_Pa, x: shear_strain, cycles: [1, 2], show: traces",
                  "shear_strain is 0 at whole cycles"),
        std::pair("y: phi, minus: {fluid: still}",
                  "2 variants have fluid=still; `minus` must select"),
        std::pair("y: phi, minus: {grains: 700}", "no variant has grains=700; `minus` must select"),
        std::pair("y: phi, minus: {fluid: still, walls: rough}",
                  "omits fluid=still,walls=smooth, fluid=cell,walls=smooth, because the subtracted "
                  "variant"),
        std::pair("y: phi, at_cycle: 2", "at_cycle has no effect")}) {
    const auto found = warnings(fmt::format("plots: [{{name: own, {}}}]\n", plot));
    ASSERT_EQ(found.size(), 1U) << plot;
    EXPECT_TRUE(has(found[0], problem)) << found[0];
  }
  EXPECT_TRUE(warnings("plots: [{name: own, y: phi, at_cycle: 3, x: drag_kg_per_s}]\n").empty());
  EXPECT_TRUE(
      warnings("plots: [{name: own, y: phi, at_cycle: 3, x: core_time_s, by: fluid}]\n").empty())
      << "a point for each variant averages over nothing";
  EXPECT_TRUE(warnings("checkpoints: {phases: [0.5]}\nplots: [{name: own, y: stress_xy_Pa, "
                       "x: shear_strain, cycles: [1, 2], show: traces}]\n")
                  .empty());
}

TEST(Expand, WarnsOfClaimsThatTooFewSeedsCannotDecide) {
  const auto warnings = [](std::uint64_t seeds) {
    return plan_of("cycles: 3",
                   "seeds: 3\nsweep: {grid: {fluid: [still, cell]}}\n"
                   "claims: [{name: same, compare: phi, margin: 1, at_cycle: 3, "
                   "between: [{fluid: still}, {fluid: cell}]}]\n",
                   {.seeds = seeds})
        .warnings;
  };
  EXPECT_TRUE(warnings(3).empty());
  ASSERT_EQ(warnings(2).size(), 1U);
  EXPECT_TRUE(
      has(warnings(2)[0], "claim same: a verdict needs at least 3 seeds, but the manifest has 2"));
}

// A small scale is for trying; it is only said if no scale decides the claim.
TEST(Expand, DoesNotWarnOfClaimsThatAnotherScaleDecides) {
  const auto warnings = [](const std::string& desk, const std::string& sides) {
    return plan_of(
               "",
               "sweep: {grid: {fluid: [still, cell], walls: [rough, smooth]}}\n"
               "scales: {smoke: {cycles: 3, seeds: 2}, desk: {" +
                   desk +
                   "}}\nclaims: [{name: same, compare: phi, margin: 1, at_cycle: 5, between: [" +
                   sides + "]}]\n",
               {.scale = "smoke"})
        .warnings;
  };
  const std::string sides = "{fluid: still, walls: rough}, {fluid: cell, walls: rough}";
  EXPECT_TRUE(warnings("cycles: 5, seeds: 3", sides).empty());
  EXPECT_EQ(warnings("cycles: 5, seeds: 2", sides).size(), 2U);
  EXPECT_EQ(warnings("cycles: 4, seeds: 3", sides).size(), 2U);
  EXPECT_TRUE(warnings("cycles: 5, seeds: 3", "{fluid: still}, {fluid: cell}").empty())
      << "the mean over both walls on both sides";
  const auto refused =
      warnings("cycles: 5, seeds: 3", "{fluid: still}, {fluid: cell, walls: rough}");
  ASSERT_FALSE(refused.empty());
  EXPECT_TRUE(has(refused[0], "2 variants have fluid=still"));
}

TEST(Expand, OptionalClaimsOfVariantsThatTheScaleLacksGiveNoWarning) {
  const auto warnings = [](const std::string& optional) {
    return plan_of("cycles: 3",
                   "seeds: 3\nsweep: {grid: {fluid: [still, cell]}}\n"
                   "claims: [{name: same, compare: phi, margin: 1, at_cycle: 0, " +
                       optional + "between: [{fluid: still}, {walls: smooth}]}]\n")
        .warnings.size();
  };
  EXPECT_EQ(warnings("optional: true, "), 0U);
  EXPECT_EQ(warnings("optional: false, "), 1U);
}

TEST(Manifest, AliasesOfLongTextsCountAsWrittenOut) {
  std::string text =
      "experiment: long\nquestion: &q \"" + std::string(100'000, 'a') + "\"\nseeds: [";
  for (int k = 0; k < 20; ++k) text += "*q, ";
  EXPECT_TRUE(has(message_of<ManifestError>([&] { parse_manifest(text + "1]\n", "long.yaml"); }),
                  "is larger than 1048576 bytes after aliases are replaced"));
}

TEST(Expand, AnAliasIsACopyOfItsAnchor) {
  const auto of_grains = [](const std::string& first, const std::string& second) {
    return parse_manifest(
        "experiment: a\nbase: {grains: " + first + "}\nscales: {s: {grains: " + second + "}}\n",
        "test.yaml");
  };
  const Manifest aliased = of_grains("&n 700", "*n"), written = of_grains("700", "700");
  EXPECT_EQ(aliased.scales[0].settings.at("grains").value,
            written.scales[0].settings.at("grains").value);
  EXPECT_EQ(aliased.scales[0].settings.at("grains").at.line, 2) << "where it is written";
  const auto series = [](const std::string& of_second) {
    return parse_manifest(
               "experiment: a\nplots:\n- {name: p, y: phi, series: &s {\"fluid=still\": {label: "
               "a}}}\n"
               "- {name: q, y: phi, series: " +
                   of_second + "}\n",
               "test.yaml")
        .plots[1]
        .series.at(0);
  };
  const SeriesSpec of_alias = series("*s"), stated = series("{\"fluid=still\": {label: a}}");
  EXPECT_EQ(of_alias.where, stated.where);
  EXPECT_EQ(of_alias.label, stated.label);
}

TEST(Expand, WarnsOfFiguresThatWouldAverageOverTheSweep) {
  const auto warnings = [](const std::string& figure, const std::string& sweep) {
    return plan_of("", fmt::format("figures: [{}]\nsweep: {{{}}}\n", figure, sweep)).warnings;
  };
  const std::string two = "grid: {amplitude_rad: [0.05, 0.1], walls: [rough, smooth]}";
  ASSERT_EQ(warnings("C", two).size(), 1U);
  EXPECT_TRUE(has(warnings("C", two)[0], "figure C would average over the values of walls"));
  EXPECT_TRUE(warnings("S2", two).empty()) << "a curve of each variant";
  EXPECT_TRUE(warnings("C", "zip: {amplitude_rad: [0.05, 0.1], walls: [rough, smooth]}").empty())
      << "they change together";
}

TEST(Expand, WarnsOfCellsWithoutInteriorGrains) {
  const auto warnings = [](const std::string& base) { return plan_of(base).warnings; };
  ASSERT_EQ(warnings("grains: 60").size(), 1U);
  EXPECT_TRUE(has(warnings("grains: 60")[0], "too small to have interior grains"));
  EXPECT_TRUE(warnings("grains: 300").empty());
}

TEST(Expand, WarnsOfKeysWithoutEffect) {
  const auto warnings = [](const std::string& base, const std::string& rest = "") {
    return plan_of(base, rest).warnings;
  };
  using Case = std::pair<std::string, std::string>;
  for (const auto& [base, warning] :
       {Case{"pause_s: 1",
             "2:17: pause_s: has an effect only under protocol paused. Leave it out."},
        Case{"protocol: stiffen, amplitude_rad: 0.1",
             "2:42: amplitude_rad: has no effect under protocol stiffen. Leave it out."},
        Case{"protocol: stiffen, cycles: 3",
             "2:35: cycles: has no effect under protocol stiffen. Leave it out."},
        Case{"stiffness_decades: 3",
             "2:27: stiffness_decades: has an effect only under protocol stiffen. Leave it out."},
        Case{"walls: smooth, wall_grain_area_fraction: 0.2",
             "2:49: wall_grain_area_fraction: has an effect only with rough walls. Leave it out."},
        Case{"walls: smooth, wall_grain_draw: 2",
             "2:40: wall_grain_draw: has an effect only with rough walls. Leave it out."}}) {
    EXPECT_EQ(warnings(base), Strings{"test.yaml:" + warning}) << base;
  }
  EXPECT_TRUE(warnings("pause_s: 1", "sweep: {grid: {protocol: [continuous, paused]}}\n").empty());
  EXPECT_EQ(warnings("protocol: stiffen", "until: {phi: 0.6}\n").size(), 1U);
  const Manifest swept = parse(
      "experiment: a\nbase: {protocol: stiffen}\nsweep: {grid: {walls: "
      "[rough, smooth]}}\n");
  EXPECT_EQ(expand(swept, {.cycles = 5}).warnings,
            Strings{"test.yaml: cycles: has no effect under protocol stiffen. Leave it out."})
      << "once, not for each variant";
}

TEST(Expand, UntilIsReadAndOverriddenAndDoesNotChangeIds) {
  const std::string text =
      "experiment: a\nscales:\n  one: {}\n  two: {until: {phi: 0.65}}\n"
      "  none: {until: none}\n";
  const Manifest manifest = parse(text + "until: {crystalline_percent: 10, extra_cycles: 15}\n");
  const PlannedRun one = at(manifest, "one").runs[0];
  EXPECT_EQ(until_from_json(one.ask.until), (Until{"crystalline_percent", 10, 15}));
  EXPECT_EQ(until_from_json(at(manifest, "two").runs[0].ask.until), (Until{"phi", 0.65, 0}));
  EXPECT_TRUE(at(manifest, "none").runs[0].ask.until.is_null());
  EXPECT_EQ(one.stage.id, at(parse(text), "one").runs[0].stage.id);
  EXPECT_EQ(to_json(until_from_json(one.ask.until)), one.ask.until);
  for (const char* bad :
       {"{}", "[]", "{\"phi\":1}", "{\"phi\":\"1\",\"extra_cycles\":1}",
        "{\"phi\":1,\"extra_cycles\":-1}", "{\"core_time_s\":1,\"extra_cycles\":1}"}) {
    EXPECT_THROW(until_from_json(nlohmann::json::parse(bad)), std::runtime_error) << bad;
  }
}

// The shortest text that distinguishes the variants, with the labels of the manifest.
TEST(Expand, NamesVariants) {
  const auto names = [](const std::string& rest) {
    Strings found;
    for (const PlannedRun& run : plan_of("grains: 600", rest).runs) found.push_back(run.name);
    return found;
  };
  EXPECT_EQ(names(""), Strings{"no sweep"});
  EXPECT_EQ(names("sweep: {grid: {fluid: [still, cell]}}\n"),
            (Strings{"fluid=still", "fluid=cell"}));
  EXPECT_EQ(names("sweep: {zip: {steps_per_cycle: [45600, 64488], settle_time_step_s: [4.4e-5, "
                  "3.1e-5], stiffness_N_per_m: [654, 1308]}}\n"),
            (Strings{"k=654 N/m", "k=1308 N/m"}));
  EXPECT_EQ(names("sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, 0.1]}}\n"
                  "labels: {fluid=still: water at rest, \"fluid=cell,amplitude_rad=0.1\": wild}\n"),
            (Strings{"water at rest, A=0.05 rad", "water at rest, A=0.1 rad",
                     "fluid=cell, A=0.05 rad", "wild"}));
}

}  // namespace
}  // namespace shearcell::test
