// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers per run, pairs, missing checkpoints: comparisons with known answers.
#include "analysis/claims.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/estimators.hpp"
#include "analysis/looks.hpp"
#include "analysis/onset.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

Scalar mean_at(const char* column, std::uint64_t first, std::uint64_t last) {
  return mean_over_cycles.scalar({.id = "own", .compare = column, .cycles = {{first, last}}});
}

// phi before most runs crystallize, and the percentage where they do.
Scalar early_phi() {
  return mean_at("phi", 1, 15);
}

Scalar percentage_over_phi() {
  return mean_over_phi.scalar(
      {.id = "own", .compare = "crystalline_percent", .phi = {{0.646, 0.67}}});
}

/// phi = start + 0.001 n + gain from cycle 1 on; the percentage rises by 1 per 0.001 of phi above
/// 0.646, plus `excess`.
FrameRun rising(std::uint64_t seed, double start, double gain = 0, double excess = 0,
                int cycles = 60) {
  FrameRun run = made_up_run("fluid", "still", seed, cycles, [=](int n, Measures& m) {
    m.numbers["phi"] = start + 0.001 * n + (n > 0 ? gain : 0);
    m.numbers["crystalline_percent"] = 1000 * (m.numbers["phi"] - 0.646) + excess;
    m.numbers["mean_overlap_d"] = 0.002 * (1 + excess);
    m.numbers["largest_crystallite"] = n;
  });
  run.packing = std::to_string(seed);
  return run;
}

constexpr double start(std::uint64_t seed) {
  return 0.62 + 0.001 * static_cast<double>(seed);
}

using Runs = std::vector<FrameRun>;

Runs group(std::size_t runs, double gain, double excess = 0, std::uint64_t first_seed = 1) {
  Runs all;
  for (std::uint64_t s = first_seed; s < first_seed + runs; ++s) {
    all.push_back(rising(s, start(s), gain, excess));
  }
  return all;
}

const Claim equal = {"equal", 0.001};

TEST(Scalars, AtOneCycleOrOverSeveral) {
  const FrameRun run = rising(1, 0.62);
  EXPECT_NEAR(mean_at("phi", 10, 10).of(run).value, 0.63, 1e-12);
  EXPECT_NEAR(early_phi().of(run).value, 0.628, 1e-12);
  EXPECT_EQ(mean_at("phi", 10, 10).name, "phi at cycle 10");
}

TEST(Scalars, ReportWhyARunHasNone) {
  FrameRun run = rising(1, 0.62, 0, 0, 14);
  EXPECT_EQ(early_phi().of(run).missing, Missing::too_short);
  run = rising(1, 0.62, 0, 0, 16);
  run.checkpoints.erase(run.checkpoints.begin() + 3);
  EXPECT_EQ(early_phi().of(run).missing, Missing::checkpoint);
  run = rising(1, std::nan(""), 0, 0, 16);
  EXPECT_EQ(early_phi().of(run).missing, Missing::undefined);
  EXPECT_EQ(percentage_over_phi().of(rising(1, 0.62, 0, 0, 30)).missing, Missing::too_short);
  EXPECT_EQ(percentage_over_phi().of(rising(1, 0.66)).missing, Missing::too_late);
  EXPECT_EQ(number_of_the_run.scalar({.id = "own", .compare = "onset_size_phi"})
                .of(rising(1, 0.62, 0, 0, 10))
                .missing,
            Missing::too_short);
}

/// A run whose crystallites grow by a grain a cycle. The critical size is 16 grains.
RunValue of_run(const std::string& expression, int cycles) {
  return NumberColumn(expression).of_run(rising(1, 0.62, 0, 0, cycles));
}

TEST(Censoring, AnExpressionThatIncreasesWithTheMeasureKeepsTheBound) {
  for (const auto& [expression, bound] :
       {std::pair("ln(onset_size_cycle/300)/ln(2)", std::log2(10 / 300.0)),
        {"onset_size_cycle^2 - 4*onset_size_cycle", 60},  // increases above 2
        {"-1/onset_size_cycle", -0.1},
        {"onset_size_cycle + amplitude_rad", 10.0833},
        {"max(5, onset_size_cycle)", 10},
        {"atan(onset_size_cycle - 1000)", std::atan(-990)}}) {
    const RunValue value = of_run(expression, 10);
    EXPECT_EQ(value.missing, Missing::too_short) << expression;
    EXPECT_NEAR(value.above, bound, 1e-12) << expression;
    EXPECT_TRUE(censored_value(value).censored) << expression;
    EXPECT_EQ(of_run(expression, 20).missing, Missing::nothing) << expression;
  }
  EXPECT_EQ(of_run("0 + onset_size_cycle", 20).value, 16);
  EXPECT_EQ(of_run("0 + onset_size_cycle", 0).above, 0) << "a run of cycle 0 alone";
}

TEST(Censoring, OtherExpressionsOfACensoredMeasureHaveNoNumber) {
  for (const char* expression :
       {"1/onset_size_cycle", "onset_slope_cycle - onset_size_cycle", "sin(onset_size_cycle/100)",
        "(onset_size_cycle - 3e5)^2", "sqrt(1000 - onset_size_cycle)", "1/(500 - onset_size_cycle)",
        "abs(onset_size_cycle - 11)", "-onset_size_cycle"}) {
    const RunValue value = of_run(expression, 10);
    EXPECT_EQ(value.missing, Missing::unbounded) << expression;
    EXPECT_FALSE(censored_value(value).censored) << expression;
  }
  EXPECT_EQ(of_run("min(5, onset_size_cycle)", 10).or_nan(), 5) << "known, whatever the onset is";
  EXPECT_EQ(of_run("onset_size_cycle/fluid", 10).missing, Missing::undefined);
}

TEST(Censoring, AClaimOfAnExpressionCountsCensoredRuns) {
  Runs runs;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    FrameRun& run = runs.emplace_back(rising(seed, 0.62, 0, 0, seed == 5 ? 15 : 60));
    for (CheckpointMeasures& one : run.checkpoints) {
      one.measures.numbers["largest_crystallite"] =
          16 * one.cycle / (10.0 + 5 * static_cast<double>(seed));
    }
  }
  ClaimSpec claim{.id = "own",
                  .compare = "2*onset_size_cycle + 1",
                  .published = PublishedSpec{.value = 41},
                  .margin = 100};
  const auto decided = [&](const char* compare) {
    claim.compare = compare;
    return claim_figure(claim).make(runs).verdicts.at(0);
  };
  const Verdict verdict = decided("2*onset_size_cycle + 1");
  EXPECT_EQ(verdict.runs, 5U);
  EXPECT_EQ(verdict.censored, 1U);
  EXPECT_EQ(verdict.note, "1 of 5 runs end before the onset and are censored");
  const Estimate same =
      censored_mean(std::vector<CensoredValue>{{-10}, {0}, {10}, {20}, {-10, true}}).value();
  EXPECT_NEAR(verdict.estimate.value().value, same.value, 1e-6);
  EXPECT_NEAR(verdict.estimate->interval.high, same.interval.high, 1e-6);
  EXPECT_TRUE(has(to_csv(entered_table({{verdict}})), ",ends before,31")) << "its bound";
  const Verdict falling = decided("-onset_size_cycle");
  EXPECT_EQ(falling.runs, 4U);
  EXPECT_EQ(falling.note,
            "1 of 5 runs are left out: they end before the onset, which gives no lower limit of "
            "-onset_size_cycle");
  claim.estimator = "spread_of_variants";
  EXPECT_TRUE(has(decided("onset_size_cycle/2").note,
                  "no verdict, because 1 of 5 runs end before the event and 0 have no number"));
  EXPECT_TRUE(has(decided("-onset_size_cycle").note, "1 of 5 runs end before the event"));
}

TEST(Scalars, PercentageIsTheMeanOverTheWindow) {
  for (const double first : {0.62, 0.6203}) {
    EXPECT_NEAR(percentage_over_phi().of(rising(1, first)).value, 12, 1e-9) << "a straight line";
  }
}

TEST(Compare, RunsThatShareAPackingArePaired) {
  const Runs a = group(4, 0.0002), b = group(4, 0);
  const Verdict verdict = compare(equal, early_phi(), pointers(a), pointers(b));
  EXPECT_EQ(verdict.ruling, Ruling::agrees) << "seeds differ by more than the margin, pairs do not";
  EXPECT_NEAR(verdict.estimate.value().value, 0.0002, 1e-12);
  EXPECT_EQ(verdict.runs, 4U);
  EXPECT_EQ(verdict.note, "4 pairs of runs that share a packing");
  EXPECT_EQ(compare(equal, early_phi(), pointers(group(4, 0.002)), pointers(b)).ruling,
            Ruling::differs);
}

TEST(Compare, RunsArePairedWithoutTheirFirstCheckpointAndWithoutInteriorGrains) {
  Runs a = group(4, 0.0002), b = group(4, 0);
  for (FrameRun& run : a) run.checkpoints.erase(run.checkpoints.begin());
  for (FrameRun& run : b) run.checkpoints.front().measures.numbers["phi"] = std::nan("");
  EXPECT_EQ(compare(equal, early_phi(), pointers(a), pointers(b)).note,
            "4 pairs of runs that share a packing");
}

TEST(Compare, OthersAreIndependent) {
  const Runs a = group(4, 0.0002), b = group(4, 0, 0, 11);
  const Verdict verdict = compare(equal, early_phi(), pointers(a), pointers(b));
  EXPECT_EQ(verdict.note, "the two sides have 4 and 4 independent runs");
  EXPECT_NEAR(verdict.estimate.value().value, -0.0098, 1e-12);
  EXPECT_EQ(verdict.ruling, Ruling::differs);
}

TEST(Compare, RelativeDifferences) {
  Scalar overlap = mean_at("mean_overlap_d", 1, 1);
  overlap.relative = true;
  const Claim claim = {"overlap", 0.03};
  const Verdict verdict =
      compare(claim, overlap, pointers(group(3, 0, 0.02, 11)), pointers(group(3, 0)));
  EXPECT_NEAR(verdict.estimate.value().value, 0.02, 1e-12);
  EXPECT_EQ(verdict.ruling, Ruling::agrees);
  EXPECT_NEAR(
      compare_with(claim, overlap, pointers(group(3, 0, 0.05)), 0.002).estimate.value().value, 0.05,
      1e-12);
}

TEST(Compare, ARelativeDifferenceNeedsPositiveNumbers) {
  Scalar overlap = mean_at("mean_overlap_d", 1, 1);
  overlap.relative = true;
  Runs a = group(4, 0, 0.02, 11);
  for (CheckpointMeasures& checkpoint : a[0].checkpoints)
    checkpoint.measures.numbers["mean_overlap_d"] = 0;
  const Claim claim = {"overlap", 0.03};
  const Verdict one = compare(claim, overlap, pointers(a), pointers(group(4, 0)));
  EXPECT_EQ(one.note,
            "the two sides have 3 and 4 independent runs; 1 of 8 runs have no ratio: their value "
            "at cycle 1 is not "
            "positive");
  EXPECT_EQ(one.runs, 3U);
  for (CheckpointMeasures& checkpoint : a[1].checkpoints)
    checkpoint.measures.numbers["mean_overlap_d"] = 0;
  EXPECT_FALSE(compare(claim, overlap, pointers(a), pointers(group(4, 0))).estimate.has_value());
}

TEST(Compare, ReportsMissingCheckpointsShortRunsAndTooFewRuns) {
  const Runs b = group(8, 0, 0, 11);
  Runs a = group(8, 0);
  a[0].checkpoints.resize(10);
  a[1].checkpoints.erase(a[1].checkpoints.begin() + 5);
  Verdict verdict = compare(equal, early_phi(), pointers(a), pointers(b));
  EXPECT_EQ(verdict.note,
            "the two sides have 6 and 8 independent runs; 1 of 16 runs lack a checkpoint of cycles "
            "1 to 15; "
            "1 of 16 runs end too early for cycles 1 to 15");
  EXPECT_TRUE(verdict.estimate.has_value());
  a[2].checkpoints.resize(10);
  verdict = compare(equal, early_phi(), pointers(a), pointers(b));
  EXPECT_FALSE(verdict.estimate.has_value()) << "3 of 8, though only 3 of all 16";
  EXPECT_TRUE(has(verdict.note, "more than a quarter of the runs are left out"));
  for (FrameRun& run : a) run.checkpoints.resize(10);
  verdict = compare(equal, early_phi(), pointers(a), pointers(b));
  EXPECT_EQ(verdict.ruling, Ruling::undecided);
  EXPECT_TRUE(has(verdict.note, "more than a quarter of the runs are left out"));
  verdict = compare(equal, early_phi(), pointers(group(2, 0)), pointers(b));
  EXPECT_EQ(verdict.note,
            "the two sides have 2 and 8 independent runs; too few runs: 2; at least 3 are needed");
  EXPECT_EQ(compare(equal, early_phi(), {}, pointers(b)).note,
            "the claim selects no runs, or its runs differ in a swept parameter that is not in "
            "the claim");
}

// Otherwise one shared packing would leave out all other runs.
TEST(Compare, TooFewPairsLeaveOutNoRun) {
  const Runs a = group(8, 0);
  const auto compared = [&](std::size_t shared) {
    Runs b = group(8, 0, 0, 11);
    for (std::size_t k = 0; k < shared; ++k) b[k] = group(8, 0.0002)[k];
    return compare(equal, early_phi(), pointers(a), pointers(b));
  };
  for (const std::size_t shared : {1, 5}) {
    const Verdict verdict = compared(shared);
    EXPECT_TRUE(verdict.estimate.has_value());
    EXPECT_EQ(verdict.counted, Counted::runs_per_variant);
    EXPECT_EQ(verdict.runs, 8U);
    EXPECT_EQ(verdict.note,
              fmt::format("the two sides have 8 and 8 independent runs; they share {} packing{}, "
                          "too few for pairs: Welch's test ignores this, so the interval is too "
                          "wide",
                          shared, shared == 1 ? "" : "s"));
  }
  EXPECT_EQ(compared(6).counted, Counted::pairs);
  EXPECT_EQ(compared(6).runs, 6U);
  EXPECT_EQ(compare(equal, early_phi(), pointers(group(4, 0)), pointers(group(8, 0))).counted,
            Counted::runs_per_variant)
      << "half of the larger group";
}

// Half of the variance lies between packings. The table is in analysis/README.md.
TEST(Compare, TheIntervalCoversTheTruthHoweverManyPackingsAreShared) {
  constexpr std::uint32_t draws = 2000;
  constexpr std::size_t runs = 8;
  Scalar scalar{"phi", "cycle 1", [](const FrameRun& run) { return measured(run.end); }};
  fmt::print("| shared packings of {} | coverage | mean length |\n|---|---|---|\n", runs);
  std::map<std::size_t, double> lengths;
  for (const std::size_t shared : {0, 1, 3, 5, 6, 8}) {
    std::uint32_t covered = 0;
    for (std::uint32_t draw = 0; draw < draws; ++draw) {
      const std::vector<double> z = normal_numbers(draw, 4 * runs);
      Runs a(runs), b(runs);
      for (std::size_t k = 0; k < runs; ++k) {
        a[k].packing = std::to_string(k);
        b[k].packing = std::to_string(k < shared ? k : k + runs);
        a[k].end = z[k] + z[k + runs];
        b[k].end = (k < shared ? z[k] : z[k + 3 * runs]) + z[k + 2 * runs];
      }
      const Verdict verdict = compare(equal, scalar, pointers(a), pointers(b));
      covered +=
          verdict.estimate.value().interval.low <= 0 && verdict.estimate.value().interval.high >= 0;
      lengths[shared] +=
          (verdict.estimate.value().interval.high - verdict.estimate.value().interval.low) / draws;
    }
    const double coverage = static_cast<double>(covered) / draws;
    fmt::print("| {} | {:.3f} | {:.2f} |\n", shared, coverage, lengths[shared]);
    EXPECT_GE(coverage, 0.9 - 0.02) << shared;
    EXPECT_TRUE(shared != 5 || coverage > 0.93) << "conservative";
  }
  EXPECT_LT(lengths[6], lengths[5]) << "pairs are the shorter ones";
}

TEST(Compare, EqualSidesAreNoEvidence) {
  const Runs a = group(4, 0), b = group(4, 0);
  const Verdict same = compare(equal, early_phi(), pointers(a), pointers(b));
  EXPECT_EQ(same.estimate.value().interval.low, 0);
  EXPECT_EQ(same.estimate.value().interval.high, 0);
  EXPECT_EQ(same.ruling, Ruling::undecided);
  EXPECT_FALSE(same.runs_needed);
  EXPECT_EQ(same.note,
            "4 pairs of runs that share a packing; the numbers of the two sides agree in every "
            "digit, usually because both sides are the same computation; this is no evidence for "
            "or against the claim");
  Runs constant = group(4, 0);
  for (FrameRun& run : constant) {
    for (CheckpointMeasures& checkpoint : run.checkpoints) checkpoint.measures.numbers["phi"] = 0.5;
  }
  const Verdict one = compare_with(equal, mean_at("phi", 1, 1), pointers(constant), 0.5);
  EXPECT_EQ(one.note, "the numbers have no scatter, so the interval has no width");
  EXPECT_EQ(one.ruling, Ruling::agrees);
}

/// Seeds 1, 2, ... of a variant, each with its phi at cycle 1.
Runs with_phi(const char* fluid, double amplitude, std::initializer_list<double> phis) {
  Runs all;
  for (const double phi : phis) {
    FrameRun& run = all.emplace_back(made_up_run(
        "fluid", fluid, all.size() + 1, 1, [phi](int, Measures& m) { m.numbers["phi"] = phi; }));
    run.parameters["amplitude_rad"] = amplitude;
    run.parameters["fluid"] = fluid;
    run.place.variant += fmt::format(",amplitude_rad={}", amplitude);
    run.stage.id += run.place.variant;
  }
  return all;
}

// Expected: numpy and scipy.stats.t. All runs together would give -0.0021.
TEST(PooledDifference, ComparesRunsWithEqualParameters) {
  Frame frame;
  for (const Runs& runs : {with_phi("still", 0.05, {0.651, 0.652, 0.654, 0.650, 0.653}),
                           with_phi("cell", 0.05, {0.650, 0.651, 0.6535}),
                           with_phi("still", 0.1, {0.660, 0.662, 0.6615}),
                           with_phi("cell", 0.1, {0.661, 0.6605, 0.663, 0.659, 0.662}),
                           with_phi("still", 0.2, {0.7, 0.8, 0.9})}) {
    frame.runs.insert(frame.runs.end(), runs.begin(), runs.end());
  }
  ClaimSpec claim{.id = "own",
                  .compare = "phi",
                  .estimator = "pooled_difference",
                  .cycles = {{1, 1}},
                  .between = {{{{"fluid", "still"}}, {{"fluid", "cell"}}}},
                  .margin = 0.002};
  const Verdict pooled = claim_figure(claim).make(frame).verdicts.at(0);
  EXPECT_NEAR(pooled.estimate.value().value, 0.000283333, 1e-9);
  EXPECT_NEAR(pooled.estimate.value().interval.low, -0.001170055, 1e-9);
  EXPECT_NEAR(pooled.estimate.value().interval.high, 0.001736722, 1e-9);
  EXPECT_EQ(pooled.ruling, Ruling::agrees);
  EXPECT_EQ(pooled.runs, 8U);
  EXPECT_EQ(
      pooled.note,
      "8 and 8 runs on the two sides, from 2 of 3 groups; the runs of a group differ only in the "
      "compared parameter and the seed, and each side of a group needs at least 3 values");
}

TEST(PooledDifference, NeedsScatterAndMostOfTheRuns) {
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .estimator = "pooled_difference",
                        .cycles = {{1, 1}},
                        .between = {{{{"fluid", "still"}}, {{"fluid", "cell"}}}},
                        .margin = 0.1};
  const auto verdict = [&](std::initializer_list<double> still,
                           std::initializer_list<double> cell) {
    Frame frame(with_phi("still", 0.05, still));
    for (const FrameRun& run : with_phi("cell", 0.05, cell)) frame.runs.push_back(run);
    return claim_figure(claim).make(frame).verdicts.at(0);
  };
  EXPECT_EQ(verdict({0.64, 0.65, 0.66}, {0.64, 0.65, 0.66}).ruling, Ruling::agrees);
  EXPECT_EQ(verdict({0.65, 0.65, 0.65}, {0.65, 0.65, 0.65}).ruling, Ruling::undecided);
  const Verdict few = verdict({0.64, 0.65, 0.66, NAN, NAN, NAN}, {0.64, 0.65, 0.66});
  EXPECT_EQ(few.ruling, Ruling::undecided);
  EXPECT_TRUE(has(few.note, "more than a quarter of the runs are left out")) << few.note;
}

// Expected: the ratios at which the test of Pitman and Morgan has p = 0.1, by scipy.stats.
TEST(SpreadRatio, IsThatOfPitmanAndMorgan) {
  Frame frame;
  const auto add = [&](double amplitude, std::initializer_list<double> a,
                       std::initializer_list<double> b) {
    Runs runs = with_phi("still", amplitude, a);
    for (std::size_t k = 0; k < runs.size(); ++k) {
      runs[k].parameters["first"] = std::data(a)[k];
      runs[k].parameters["second"] = std::data(b)[k];
      frame.runs.push_back(runs[k]);
    }
  };
  add(0.05, {1, 2, 3, 5}, {2, 1, 4, 6});
  add(0.1, {7, 9, 8}, {10, 8, 13});
  const ClaimSpec claim{.id = "own",
                        .compare = "first",
                        .estimator = "spread_ratio",
                        .against = "second",
                        .margin = 0.1,
                        .is = Relation::lower};
  const Verdict found = claim_figure(claim).make(frame).verdicts.at(0);
  EXPECT_NEAR(found.estimate.value().value, -0.373823296, 1e-8);
  EXPECT_NEAR(found.estimate.value().interval.low, -0.728180503, 1e-8);
  EXPECT_NEAR(found.estimate.value().interval.high, 0.442491319, 1e-8);
  EXPECT_EQ(found.margin, -0.1);
  EXPECT_EQ(found.ruling, Ruling::undecided);
  EXPECT_EQ(found.note,
            "7 of 7 runs have values of both measures, in 2 variants; Pitman-Morgan test");
}

TEST(CannotBeDecided, IsTheVerdictWithItsReasonWhateverTheNumbers) {
  Frame frame(group(4, 0.0002));
  ClaimSpec claim{.id = "own",
                  .compare = "phi",
                  .cycles = {{1, 15}},
                  .published = PublishedSpec{.value = 0.63},
                  .margin = 0.1,
                  .cannot_be_decided = "the published number has no error"};
  Verdict verdict = claim_figure(claim).make(frame).verdicts.at(0);
  EXPECT_EQ(name_of(verdict.ruling), "cannot be decided");
  EXPECT_TRUE(has(verdict.note, "the published number has no error"));
  EXPECT_TRUE(verdict.estimate.has_value());
  EXPECT_FALSE(verdict.runs_needed);
  frame.seeds = {1, 2, 3, 4, 5};
  frame.looks = {5};
  frame.pending = group(1, 0, 0, 5);
  verdict = claim_figure(claim).make(frame).verdicts.at(0);
  EXPECT_EQ(verdict.ruling, Ruling::undecidable) << "before its look, too";
  claim.cannot_be_decided.clear();
  EXPECT_EQ(claim_figure(claim).make(frame).verdicts.at(0).ruling, Ruling::undecided);
  const Claim stated{.text = "own", .margin = 0.1, .cannot_be_decided = "a reason"};
  const Runs runs = group(4, 0);
  EXPECT_EQ(compare(stated, early_phi(), pointers(runs), pointers(runs)).ruling,
            Ruling::undecidable)
      << "also if both sides are equal";
}

TEST(Claims, NameASideWithoutRunsAsItsPlannedRuns) {
  Frame frame(group(3, 0));
  frame.pending = with_phi("cell", 0.0833, {0.6});
  frame.pending.front().name = "moving fluid";
  for (FrameRun& run : frame.runs) run.name = "still fluid";
  for (FrameRun& run : frame.runs) run.parameters["fluid"] = "still";
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .cycles = {{1, 1}},
                        .between = {{{{"fluid", "cell"}}, {{"fluid", "still"}}}},
                        .margin = 0.1};
  EXPECT_EQ(claim_figure(claim).make(frame).verdicts.at(0).text,
            "own: phi at cycle 1 is the same for moving fluid and still fluid");
}

TEST(CompareWaits, CountsRunsThatEndBefore) {
  Runs a = group(4, 0), b = group(4, 0, 0, 11);
  a[0].checkpoints.resize(12);
  for (FrameRun& run : a) run.name = "still fluid";
  const Verdict verdict =
      waiting_ratio.decide({.id = "own"}, {"onset", 1}, pointers(a), pointers(b));
  const Table entered = entered_table(std::span(&verdict, 1));
  EXPECT_EQ(entered.rows.size(), 8U);
  EXPECT_EQ(std::get<std::string>(entered.rows[0].back()), "ends before");
  EXPECT_EQ(std::get<std::string>(entered.rows[1].back()), "");
  EXPECT_EQ(
      verdict.note,
      "still fluid: median cycle 16 (1 of 4 runs end before the event); second: median cycle 16 "
      "(0 of 4 runs end before the event); the waiting times have no scatter at these checkpoints, "
      "so "
      "the interval has no width");
  EXPECT_EQ(verdict.ruling, Ruling::undecided);
  const ClaimSpec rises{.id = "own", .compare = "crystalline_percent", .reaches = 5};
  const Table cycles = first_cycle_reached.decide(rises, {"rise", 1}, pointers(a), {}).entered;
  EXPECT_EQ(cycles.rows[0].at(3), TableCell(11.0));
  EXPECT_EQ(cycles.rows[0].at(4), TableCell("ends before"));
  EXPECT_EQ(cycles.rows[1].at(3), TableCell(29.0)) << "phi = 0.622 + 0.029";
}

/// Runs of these seeds, whose phi is `phi` and differs a little.
std::vector<FrameRun> with_seeds(std::initializer_list<std::uint64_t> seeds, double phi) {
  std::vector<FrameRun> runs;
  for (const std::uint64_t seed : seeds) {
    runs.push_back(made_up_run("fluid", "still", seed, 1, [&](int, Measures& m) {
      m.numbers["phi"] = phi + 1e-5 * static_cast<double>(seed % 3);
    }));
  }
  return runs;
}

/// That phi is 0.6, within 0.001.
Verdict at_looks(const Frame& frame) {
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .cycles = {{1, 1}},
                        .between = {{{{"fluid", "still"}}, nlohmann::json::object()}},
                        .published = PublishedSpec{.label = "", .source = "a", .value = 0.6},
                        .margin = 0.001};
  return claim_figure(claim).make(frame).verdicts.at(0);
}

/// Seeds 1 to 6, of which `ended` have ended.
Frame planned(std::initializer_list<std::uint64_t> ended, double phi,
              std::vector<std::size_t> looks = {}) {
  Frame frame(with_seeds(ended, phi));
  frame.seeds = {1, 2, 3, 4, 5, 6};
  frame.looks = std::move(looks);
  for (const FrameRun& run : with_seeds({1, 2, 3, 4, 5, 6}, phi)) {
    if (std::ranges::find(ended, run.place.seed) == ended.end()) frame.pending.push_back(run);
  }
  return frame;
}

TEST(PlannedLooks, GiveNoVerdictBetweenThem) {
  const Verdict early = at_looks(planned({1, 2}, 0.6, {3, 6}));
  EXPECT_EQ(early.ruling, Ruling::undecided);
  EXPECT_EQ(early.look, 0U);
  EXPECT_TRUE(
      has(early.note, "2 of 6 seeds have ended; the next look (interim analysis) is at 3 seeds"));
  const Verdict gap = at_looks(planned({1, 3, 4, 5, 6}, 0.6, {3, 6}));
  EXPECT_EQ(gap.ruling, Ruling::undecided) << "never the first that finished";
  EXPECT_TRUE(
      has(gap.note, "1 of 6 seeds have ended; the next look (interim analysis) is at 3 seeds"));
  const Verdict between = at_looks(planned({1, 2, 3, 4}, 0.601, {3, 6}));
  EXPECT_EQ(between.ruling, Ruling::undecided);
  EXPECT_EQ(between.runs, 4U) << "numbers of all that have ended";
  EXPECT_TRUE(has(between.note, "the next look (interim analysis) is at 6 seeds"));
  EXPECT_TRUE(has(between.note, "with probability 0."));
}

TEST(PlannedLooks, TheFirstVerdictIsFinal) {
  const double level = look_level(std::vector<std::size_t>{3, 6});
  Frame frame = planned({1, 2, 3}, 0.6, {3, 6});
  EXPECT_EQ(at_looks(frame).ruling, Ruling::agrees);
  for (FrameRun& run : with_seeds({4, 5, 6}, 0.7)) frame.runs.push_back(run);
  frame.pending.clear();
  const Verdict verdict = at_looks(frame);
  EXPECT_EQ(verdict.ruling, Ruling::agrees) << "whatever later runs say";
  EXPECT_EQ(verdict.runs, 3U);
  EXPECT_EQ(verdict.look, 3U);
  EXPECT_EQ(verdict.level, level);
  const nlohmann::json json = to_json({{verdict}}).at("claims").at(0);
  EXPECT_EQ(json.at("looks"), (std::vector{3, 6}));
  EXPECT_EQ(json.at("look"), 3);
  EXPECT_NEAR(json.at("level").get<double>(), level, 1e-6);
  const Verdict later = at_looks(planned({1, 2, 3, 4, 5, 6}, 0.7, {4, 6}));
  EXPECT_EQ(later.ruling, Ruling::differs);
  EXPECT_EQ(later.look, 4U);
}

TEST(PlannedLooks, WidenTheIntervalOfABound) {
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .cycles = {{1, 1}},
                        .between = {{{{"fluid", "still"}}, nlohmann::json::object()}},
                        .published = PublishedSpec{.label = "", .source = "a", .value = 0.7},
                        .is = Relation::lower};
  const Verdict bound = claim_figure(claim).make(planned({1, 2, 3}, 0.6, {3, 6})).verdicts.at(0);
  EXPECT_EQ(bound.ruling, Ruling::supported);
  EXPECT_EQ(bound.margin, 0.7);
  EXPECT_EQ(bound.level, look_level(std::vector<std::size_t>{3, 6}));
}

// The power is the probability that the looks decide about 0.6, not about 0.
TEST(PlannedLooks, ThePowerOfABoundIsForThePublishedNumber) {
  const auto power = [](double published) {
    const ClaimSpec claim{
        .id = "own",
        .compare = "phi",
        .cycles = {{1, 1}},
        .between = {{{{"fluid", "still"}}, nlohmann::json::object()}},
        .published = PublishedSpec{.label = "", .source = "a", .value = published},
        .is = Relation::higher};
    return claim_figure(claim).make(planned({1, 2, 3, 4}, 0.6, {5, 6})).verdicts.at(0).power;
  };
  EXPECT_LT(power(0.600015).value(), 0.5);
  EXPECT_GT(power(0.5).value(), 0.99);
}

TEST(PlannedLooks, AClaimThatCannotBeDecidedHasTheNumbersOfTheLastLook) {
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .cycles = {{1, 1}},
                        .between = {{{{"fluid", "still"}}, nlohmann::json::object()}},
                        .published = PublishedSpec{.label = "", .source = "a", .value = 0.6},
                        .margin = 0.001,
                        .cannot_be_decided = "a reason"};
  const Verdict all =
      claim_figure(claim).make(planned({1, 2, 3, 4, 5, 6}, 0.6, {3, 6})).verdicts.at(0);
  EXPECT_EQ(all.ruling, Ruling::undecidable);
  EXPECT_EQ(all.look, 6U);
  EXPECT_EQ(all.runs, 6U);
}

TEST(PlannedLooks, ThePowerOfASlopeCountsTheRunsOfAllVariants) {
  const auto slopes = [](std::size_t variants) {
    Frame frame;
    frame.seeds = {1, 2, 3, 4, 5, 6};
    frame.looks = {3, 6};
    for (std::size_t k = 0; k < variants; ++k) {
      for (const std::uint64_t seed : frame.seeds) {
        const double grains = k % 2 == 0 ? 1000 : 2000;
        FrameRun run = made_up_run("grains", grains, seed, 1, [](int, Measures&) {});
        run.place.variant += std::to_string(k);
        run.parameters["period_s"] = 1.0 + 0.01 * static_cast<double>(seed % 2);
        (seed < 3 ? frame.runs : frame.pending).push_back(run);
      }
    }
    const ClaimSpec claim{.id = "own",
                          .compare = "period_s",
                          .estimator = "slope",
                          .against = "grains",
                          .margin = 8e-6};
    return claim_figure(claim).make(frame).verdicts.at(0);
  };
  const Verdict two = slopes(2), six = slopes(6);
  ASSERT_TRUE(two.power && six.power) << two.note << "\n" << six.note;
  EXPECT_GT(*six.power, *two.power);
}

TEST(PlannedLooks, WithoutThemThereIsOneAtAllSeeds) {
  EXPECT_EQ(at_looks(planned({1, 2, 3, 4, 5}, 0.6)).ruling, Ruling::undecided);
  const Verdict all = at_looks(planned({1, 2, 3, 4, 5, 6}, 0.6));
  EXPECT_EQ(all.ruling, Ruling::agrees);
  EXPECT_EQ(all.level, confidence_level);
  EXPECT_FALSE(to_json({{all}}).at("claims").at(0).contains("look"));
}

TEST(PlannedLooks, RunsOfOtherSeedsAreAnUnplannedLook) {
  Frame frame = planned({1, 2, 3, 4, 5, 6}, 0.6);
  for (FrameRun& run : with_seeds({70, 71, 72, 73}, 0.7)) frame.runs.push_back(run);
  const Verdict verdict = at_looks(frame);
  EXPECT_EQ(verdict.ruling, Ruling::agrees);
  EXPECT_EQ(verdict.runs, 6U);
  EXPECT_TRUE(
      has(verdict.note,
          "an unplanned look (interim analysis), with 4 seeds more than planned, gives: 0.04"));
}

TEST(PlannedLooks, TheLastOneIsFinalEvenIfItDecidesNothing) {
  const Verdict verdict = at_looks(planned({1, 2, 3, 4, 5, 6}, 0.601, {3}));
  EXPECT_EQ(verdict.ruling, Ruling::undecided);
  EXPECT_EQ(verdict.runs, 3U);
  EXPECT_FALSE(verdict.runs_needed);
  EXPECT_TRUE(has(verdict.note, "the last planned look has not decided the claim"));
  EXPECT_TRUE(has(verdict.note,
                  "an unplanned look (interim analysis), with 3 seeds more than planned, gives: "));
}

TEST(PlannedLooks, UseSeedsThatBothSidesHave) {
  Frame frame(with_seeds({1, 2, 3, 4, 5, 6}, 0.6));
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    frame.runs.push_back(made_up_run("fluid", "cell", seed, 1, [&](int, Measures& m) {
      m.numbers["phi"] = 0.6 + 1e-5 * static_cast<double>(seed % 3);
    }));
  }
  frame.seeds = {1, 2, 3, 4, 5, 6};
  frame.looks = {3, 6};
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .cycles = {{1, 1}},
                        .between = {{{{"fluid", "still"}}, {{"fluid", "cell"}}}},
                        .margin = 0.001};
  const Verdict verdict = claim_figure(claim).make(frame).verdicts.at(0);
  EXPECT_EQ(verdict.looks, (std::vector<std::size_t>{3, 4})) << "the last look has all of them";
  EXPECT_EQ(verdict.look, 3U);
  EXPECT_EQ(verdict.ruling, Ruling::agrees);
}

TEST(OwnClaims, OfEveryEstimatorAreUndecidedWithoutRuns) {
  for (const Estimator& one : all_estimators()) {
    ClaimSpec claim{.id = "own",
                    .compare = one.of_run.value_or(false) ? "onset_size_phi" : "phi",
                    .estimator = std::string(one.name),
                    .cycles = {{9, 9}},
                    .phi = {{0.64, 0.65}},
                    .reaches = 1,
                    .against = "interior_grains",
                    .where = {{"walls", "rough"}},
                    .margin = 0.001};
    if (!one.one_side) claim.between = {{{{"fluid", "still"}}, {{"fluid", "cell"}}}};
    const Verdict verdict = claim_figure(claim).make(Frame()).verdicts.at(0);
    EXPECT_EQ(verdict.ruling, Ruling::undecided) << one.name;
    EXPECT_TRUE(has(verdict.note, "walls=rough has a checkpoint")) << one.name << verdict.note;
  }
}

TEST(RunsWith, CountARunOfTwoExperimentsOnce) {
  std::vector<FrameRun> runs = with_seeds({1, 2}, 0.6);
  runs.push_back(runs.front());
  for (std::size_t k = 0; k < 3; ++k) {
    runs[k].place.experiment = runs[k].place.swept["experiment"] = k < 2 ? "first" : "second";
  }
  EXPECT_EQ(runs_with(nlohmann::json::object(), runs).size(), 2U);
  EXPECT_EQ(runs_with({{"experiment", "second"}}, runs), (std::vector{&std::as_const(runs[2])}));
}

TEST(IsWithin, ComparesWholeNumbersExactly) {
  EXPECT_FALSE(is_within(4560001, 4560000));
  EXPECT_TRUE(is_within(4560000, 4560000U));
  EXPECT_TRUE(is_within(0.05000000001, 0.05));
}

TEST(ClaimSides, ShareNoRun) {
  std::vector<FrameRun> runs = with_seeds({1, 2, 3}, 0.6);
  for (FrameRun& run : with_seeds({3, 4}, 0.6)) runs.push_back(run);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    runs[k].place.experiment = runs[k].place.swept["experiment"] = k < 3 ? "first" : "second";
    runs[k].place.variant += runs[k].place.experiment;
  }
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .cycles = {{1, 1}},
                        .between = {{{{"experiment", "first"}}, {{"experiment", "second"}}}},
                        .margin = 0.001};
  EXPECT_EQ(problems_of_sides(claim, sides_of(claim, runs), false),
            (std::vector<std::string>{
                "1 run is on both sides of `between`. Select sides that share no run."}));
}

}  // namespace
}  // namespace shearcell::test
