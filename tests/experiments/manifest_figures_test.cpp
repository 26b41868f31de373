// SPDX-License-Identifier: GPL-3.0-or-later
// A plan warns of plots and claims that the runs will give no value for.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "provenance/sha256.hpp"
#include "tests/experiments/plan_of.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using Strings = std::vector<std::string>;

const std::string kThreeSeeds = "seeds: 3\nsweep: {grid: {fluid: [still, cell]}}\n";

std::string claim(const std::string& what) {
  return fmt::format(
      "claims: [{{name: own, margin: 1, between: [{{fluid: still}}, {{fluid: cell}}], {}}}]\n",
      what);
}

std::string plot(const std::string& what) {
  return fmt::format("plots: [{{name: own, {}}}]\n", what);
}

Strings warnings(int cycles, const std::string& own) {
  return plan_of(fmt::format("cycles: {}", cycles),
                 kThreeSeeds + "checkpoints: {every_cycles: 2}\n" + own)
      .warnings;
}

// With 4 cycles there are checkpoints at 0, 2 and 4; with 5 cycles also at 5, the last one.
TEST(FigureWarnings, OfCyclesWithoutACheckpoint) {
  const std::string against_drag = "y: phi, x: drag_kg_per_s, at_cycle: ";
  for (const std::string& good :
       {plot(against_drag + "2"), plot(against_drag + "4"), claim("compare: phi, at_cycle: 2"),
        plot("y: phi, show: traces, cycles: [1, 2]"), plot("y: phi, x: drag_kg_per_s"),
        claim("compare: onset_size_phi")}) {
    EXPECT_EQ(warnings(4, good), Strings{}) << good;
  }
  for (const auto& [bad, says] :
       {std::pair{plot(against_drag + "3"),
                  "plot own: runs lack a checkpoint at cycle 3, so phi has no value"},
        {plot("y: pair_correlation, at_cycle: 3"), "runs lack a checkpoint at cycle 3"},
        {plot("y: phi, show: traces, cycles: [3, 3]"), "runs lack a checkpoint at cycle 3"},
        {claim("compare: phi, at_cycle: 3"), "claim own: runs lack a checkpoint at cycle 3, so"},
        {claim("compare: phi, cycles: [2, 4]"), "runs lack a checkpoint at cycle 3"},
        {claim("compare: phi, at_cycle: 5"), "runs lack a checkpoint at cycle 5"}}) {
    const Strings found = warnings(4, bad);
    ASSERT_EQ(found.size(), 1U) << bad;
    EXPECT_TRUE(has(found[0], says)) << found[0];
  }
  EXPECT_EQ(warnings(5, claim("compare: phi, cycles: [4, 5]")), Strings{}) << "the last cycle";
}

TEST(FigureWarnings, OfMeasuresThatNeedAnEarlierCheckpoint) {
  for (const auto& [bad, says] :
       {std::pair{
            plot("y: msd_1_cycle_d2"),
            "lack a checkpoint in cycles 0 to 4 and another checkpoint 1 cycle earlier, so msd_1"},
        {plot("y: phi, x: reversible_percent"), "so reversible_percent has no value"},
        {plot("y: msd_10_cycles_d2"), "and another checkpoint 10 cycles earlier"},
        {plot("y: work_of_walls_per_cycle_J, x: drag_kg_per_s"), "a checkpoint at cycle 4 and"},
        {claim("compare: d2min_1_cycle_d2, at_cycle: 4"),
         "at cycle 4 and another checkpoint 1 cycle"}}) {
    const Strings found = warnings(4, bad);
    ASSERT_EQ(found.size(), 1U) << bad;
    EXPECT_TRUE(has(found[0], says)) << found[0];
  }
  EXPECT_EQ(warnings(12, plot("y: msd_10_cycles_d2")), Strings{});
  EXPECT_EQ(warnings(5, plot("y: msd_1_cycle_d2")), Strings{}) << "at the last cycle";
  EXPECT_EQ(warnings(5, claim("compare: d2min_1_cycle_d2, at_cycle: 5")), Strings{});
}

// Each side of a claim has the length of its own variant.
TEST(FigureWarnings, OfAClaimBeyondTheEndOfOneSide) {
  const auto found =
      plan_of("", "seeds: 3\nsweep: {zip: {fluid: [still, cell], cycles: [10, 4]}}\n" +
                      claim("compare: phi, at_cycle: 8"))
          .warnings;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(has(found[0], "runs lack a checkpoint at cycle 8"));
}

// `run --cycles 2` after `run --cycles 5` leaves the runs with 5 cycles.
TEST(FigureWarnings, TakeTheLengthThatTheStoreHas) {
  const std::string text =
      "experiment: a\nbase: {cycles: 3}\n" + kThreeSeeds + claim("compare: phi, at_cycle: 3");
  const Manifest manifest = parse_manifest(text, "test.yaml");
  const auto warned = [&](const std::vector<Stage>& known) {
    return expand(manifest, {.cycles = 2, .known = known}).warnings.size();
  };
  EXPECT_EQ(warned({}), 1U);
  std::vector<Stage> known;
  for (const char* variant : {"fluid=still", "fluid=cell"}) {
    Membership& m = known.emplace_back().memberships.emplace_back();
    m.place = {.experiment = "a", .variant = variant, .seed = 1, .manifest = sha256_hex(text)};
    m.ask.target_cycles = 5;
  }
  EXPECT_EQ(warned(known), 0U);
  known[0].memberships[0].place.manifest = sha256_hex("another text");
  EXPECT_EQ(warned(known), 1U) << "figures take what their own manifest asks for";
}

// Without gravity, pressure_at has no effect.
TEST(FigureWarnings, OfAClaimBetweenVariantsThatAreTheSameRuns) {
  const auto found = [](const std::string& between) {
    return plan_of("cycles: 1",
                   "seeds: 3\nsweep: {grid: {gravity_m_per_s2: [0, 9.81], pressure_at: [top, "
                   "moving_wall]}}\nclaims: [{name: own, margin: 1, compare: phi, at_cycle: 1, "
                   "between: [" +
                       between + "]}]\n")
        .warnings;
  };
  const std::string top = "{gravity_m_per_s2: 0, pressure_at: top}";
  const Strings same = found(top + ", {gravity_m_per_s2: 0, pressure_at: moving_wall}");
  ASSERT_EQ(same.size(), 2U);
  EXPECT_TRUE(has(same[0], "share all runs (computed once)"));
  EXPECT_TRUE(has(same[1], "claim own: both sides of `between` select the same runs"));
  EXPECT_EQ(found(top + ", {gravity_m_per_s2: 9.81, pressure_at: top}").size(), 1U);
}

TEST(FigureWarnings, OfASeriesThatFitsSeveralCurves) {
  const auto found = [](const std::string& own) {
    return plan_of(
               "cycles: 4",
               "sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, 0.1]}}\n" + plot(own))
        .warnings;
  };
  const std::string series = ", series: {\"fluid=still\": {colour: black}}";
  const Strings several = found("y: phi" + series);
  ASSERT_EQ(several.size(), 1U);
  EXPECT_TRUE(has(several[0], "plot own: the style for fluid=still matches 2 curves"))
      << several[0];
  EXPECT_EQ(found("y: phi, x: amplitude_rad" + series), Strings{});
  EXPECT_EQ(found("y: phi, x: 2*amplitude_rad" + series), Strings{});
  EXPECT_EQ(found("y: phi, panel: amplitude_rad" + series), Strings{});
  EXPECT_EQ(found("y: phi, by: fluid, panel: amplitude_rad" + series), Strings{});
  EXPECT_EQ(found("y: phi, series: {\"fluid=still,amplitude_rad=0.1\": {colour: black}}"),
            Strings{});
}

// As `figures` does, a plan looks only at the runs that `where` selects.
TEST(FigureWarnings, OfTheRunsThatThePlotSelects) {
  const auto found = [](const std::string& own, const std::string& more = "") {
    return plan_of("cycles: 4",
                   "sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, 0.1]}}\n" + more +
                       plot("y: phi, " + own))
        .warnings;
  };
  const std::string still = "series: {\"fluid=still,amplitude_rad=0.1\": {colour: black}}, ";
  for (const std::string& good :
       {std::string("by: amplitude_rad, where: {fluid: still}"),
        std::string("minus: {fluid: still, amplitude_rad: 0.05}, where: {amplitude_rad: 0.05}"),
        still + "where: {fluid: still}", std::string("where: {cycle: {min: 4}}"),
        std::string("where: {cycle: [3, 9]}"),
        std::string("x: amplitude_rad, where: {cycle: {max: 2}}")}) {
    EXPECT_EQ(found(good), Strings{}) << good;
  }
  for (const auto& [bad, says] :
       {std::pair{std::string("where: {amplitude_rad: 0.07}"),
                  "no run is left with amplitude_rad=0.07, so nothing is drawn"},
        {"where: {amplitude_rad: {min: 0.2, max: 0.1}}",
         "no run is left with amplitude_rad 0.2 to 0.1, so nothing is drawn"},
        {"where: {cycle: {min: 9}}", "lack a checkpoint in cycles 0 to 4 with cycle >= 9, so phi"},
        {"x: amplitude_rad, at_cycle: 4, where: {cycle: {max: 2}}",
         "lack a checkpoint at cycle 4 with cycle <= 2, so phi"},
        {"minus: {fluid: still, amplitude_rad: 0.05}, where: {fluid: still, amplitude_rad: 0.05}",
         "no run is left with amplitude_rad=0.05, fluid=still, so nothing is drawn"},
        {still + "where: {fluid: cell}", "matches 0 curves"}}) {
    const Strings one = found(bad);
    ASSERT_EQ(one.size(), 1U) << bad;
    EXPECT_TRUE(has(one[0], says)) << one[0];
  }
}

TEST(FigureWarnings, OfAClaimThatSelectsNoVariant) {
  const Strings found = warnings(4, claim("compare: phi, at_cycle: 4, where: {walls: smooth}"));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(has(found[0], "no variant has fluid=still, walls=smooth; `between` must select"));
}

TEST(FigureWarnings, OfASpreadOfOneVariant) {
  const auto found = [](const std::string& more) {
    return warnings(4,
                    "claims: [{name: own, margin: 1, compare: phi, at_cycle: 4, "
                    "estimator: spread_of_variants" +
                        more + "}]\n");
  };
  EXPECT_EQ(found(""), Strings{});
  const Strings one = found(", where: {fluid: still}");
  ASSERT_EQ(one.size(), 1U);
  EXPECT_TRUE(has(one[0], "spread_of_variants compares variants, but the claim selects only one"));
}

TEST(FigureWarnings, OfAManifestThatUsesOtherExperiments) {
  const auto found = [](const std::string& own) {
    return expand(parse_manifest("experiment: joint\nof: [a, b]\n" + own, "test.yaml")).warnings;
  };
  EXPECT_EQ(found(plot("y: phi, where: {experiment: [a, b]}")), Strings{});
  EXPECT_THROW(found(plot("y: phi, where: {experiment: [a, c]}")), ManifestError);
  for (const auto& [bad, says] :
       {std::pair{plot("y: phi, at_cycle: 2"), "plot own: at_cycle has no effect"},
        {std::string("claims: [{name: own, margin: 1, compare: phi, at_cycle: 1, "
                     "between: [{fluid: still}, {fluid: still}]}]\n"),
         "claim own: both sides of `between` are the same"}}) {
    const Strings one = found(bad);
    ASSERT_EQ(one.size(), 1U) << bad;
    EXPECT_TRUE(has(one[0], says)) << one[0];
  }
}

TEST(FigureWarnings, OfASeriesThatFitsNoCurve) {
  const auto found = [](const std::string& series) {
    return plan_of("cycles: 4", "sweep: {grid: {amplitude_rad: [0.05, 0.1]}}\n" +
                                    plot("y: phi, by: amplitude_rad, series: " + series))
        .warnings;
  };
  EXPECT_EQ(found("{0.05: {colour: black}}"), Strings{});
  const Strings none = found("{0.06: {colour: black}}");
  ASSERT_EQ(none.size(), 1U);
  EXPECT_TRUE(has(none[0], "plot own: the style for amplitude_rad=0.06 matches 0 curves"))
      << none[0];
  // It may be of another scale.
  const std::string scales =
      "scales: {a: {sweep: {grid: {fluid: [still, cell]}}}, desk: {sweep: {grid: {fluid: "
      "[still]}}}}\n";
  EXPECT_EQ(
      plan_of("cycles: 4", scales + plot("y: phi, by: fluid, series: {cell: {colour: black}}"))
          .warnings,
      Strings{});
}

// As of plots and claims of its own.
TEST(FigureWarnings, OfListedFigures) {
  const auto found = [](const std::string& base, const std::string& more) {
    return plan_of(base, "figures: [S2, B5]\n" + more).warnings;
  };
  const Strings short_runs = found("cycles: 4", kThreeSeeds);
  ASSERT_FALSE(short_runs.empty());
  EXPECT_TRUE(std::ranges::any_of(short_runs, [](const std::string& one) {
    return has(one, "figure S2: claim") && has(one, "runs lack a checkpoint at cycle");
  })) << fmt::format("{}", fmt::join(short_runs, "\n"));
}

// Manifests of earlier versions name claims by what they say. A label is part of what a claim says.
TEST(FigureWarnings, OfPrimaryClaimsThatAreStatements) {
  const auto found = [](const std::string& primary, const std::string& more) {
    return warnings(4,
                    claim("compare: phi, at_cycle: 4") + "primary: ['" + primary + "']\n" + more);
  };
  const std::string says = "own: phi at cycle 4 is the same for fluid=still and fluid=cell";
  const std::string label = "labels: {\"fluid=still\": water}\n";
  EXPECT_EQ(found("own", ""), Strings{});
  for (const auto& [statement, with] :
       {std::pair{says, std::string()},
        {std::string("own: phi at cycle 4 is the same for water and fluid=cell"), label}}) {
    EXPECT_EQ(found(statement, with), Strings{"primary: '" + statement +
                                              "' is the statement of a claim. Write its id, own."});
  }
  EXPECT_THROW(found(says, label), ManifestError);
}

// bad.txt has the entries that are refused.
TEST(Primary, NamesClaimsWithAndWithoutTheValueOfForEach) {
  const std::string claims =
      "claims: [{id: p.one, for_each: amplitude_rad, margin: 1, compare: phi, at_cycle: 1, "
      "between: [{fluid: still}, {fluid: cell}]}]\n";
  const std::string scales =
      "scales: {desk: {sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.05, 0.1]}}}, smoke: "
      "{sweep: {grid: {fluid: [still, cell], amplitude_rad: [0.1]}}}}\n";
  for (const char* primary :
       {"p.one", "p.one@amplitude_rad=0.05", "p.one@amplitude_rad=0.1", "C.growth",
        "C.critical_size@amplitude_rad=0.05", "S5a.onset@amplitude_rad=0.05"}) {
    const std::string text = fmt::format("primary: [{}]\nfigures: [C, S5a]\n", primary);
    EXPECT_NO_THROW(plan_of("cycles: 1", claims + scales + text)) << primary;
  }
  const std::string of_others =
      "experiment: b\nof: [a]\nprimary: [p.one@amplitude_rad=0.07]\n" + claims;
  EXPECT_NO_THROW(parse_manifest(of_others, "test.yaml")) << "other manifests define the values";
  EXPECT_NO_THROW(read_manifest("experiment: a\nprimary: [gone]\n", "test.yaml"))
      << "stores hold such manifests";
}

TEST(Claims, CanHaveASlopeAgainstAParameter) {
  const Manifest manifest = parse_manifest(
      "experiment: a\nsweep: {grid: {amplitude_rad: [0.05, 0.1]}}\nclaims: [{id: s, compare: "
      "onset_size_phi, estimator: slope, against: amplitude_rad, margin: 1}]\n",
      "test.yaml");
  EXPECT_EQ(manifest.claims.at(0).against, "amplitude_rad");
}

TEST(FigureWarnings, OfExpressionsAndPublishedClaims) {
  for (const auto& [bad, says] :
       {std::pair{plot("y: phi*msd_10_cycles_d2"), "so phi*msd_10_cycles_d2 has no value"},
        {plot("y: 2*onset_size_phi, x: drag_kg_per_s, at_cycle: 2"),
         "has one value for each run, so at_cycle has no effect"},
        {plot("y: phi, x: 1/drag_kg_per_s, at_cycle: 3"), "runs lack a checkpoint at cycle 3"},
        {std::string(
             "claims: [{name: own, margin: 1, compare: phi, at_cycle: 2, of: {walls: rough}, "
             "published: {value: 1, source: a}}]\n"),
         "2 variants have walls=rough; `of` must select one variant."},
        {std::string(
             "claims: [{name: own, margin: 1, compare: phi, at_cycle: 2, published: {value: "
             "1, source: a}}]\n"),
         "there are 2 variants; `of` must select one variant."},
        {std::string("claims: [{name: own, margin: 1, compare: phi/2, at_cycle: 3, of: {fluid: "
                     "still}, published: {value: 1, source: a}}]\n"),
         "runs lack a checkpoint at cycle 3"}}) {
    const Strings found = warnings(4, bad);
    ASSERT_EQ(found.size(), 1U) << bad;
    EXPECT_TRUE(has(found[0], says)) << found[0];
  }
}

}  // namespace
}  // namespace shearcell::test
