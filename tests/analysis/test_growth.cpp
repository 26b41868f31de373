// SPDX-License-Identifier: GPL-3.0-or-later
// Crystallites with known fates: growth, merging, breaking, vanishing, ties. Logistic regression
// where it has a closed form, and on counts that follow a logistic curve.
#include "analysis/growth.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::test {
namespace {

GrowthCount fate(const std::vector<std::int32_t>& crystallite, const CrystalliteMap& later) {
  GrowthBySize counts;
  follow(map_of({crystallite}), later, counts);
  EXPECT_EQ(counts.size(), 1U);
  return counts[static_cast<std::int32_t>(crystallite.size())];
}

TEST(Follow, TheMajorityDecides) {
  const GrowthCount grew{1, 0, 0}, shrank{0, 1, 0}, vanished{0, 1, 1}, neither{};
  EXPECT_EQ(fate({1, 2, 3}, map_of({{1, 2, 7, 8}})), grew) << "two of three in a larger one";
  EXPECT_EQ(fate({1, 2, 3}, map_of({{1, 7, 8, 9}})), vanished) << "one of three in a larger one";
  EXPECT_EQ(fate({1, 2, 3}, map_of({{1, 2}})), shrank);
  EXPECT_EQ(fate({1, 2, 3}, map_of({{2, 3, 9}})), neither) << "most in one of the same size";
  EXPECT_EQ(fate({4, 5}, map_of({})), vanished) << "vanishing is shrinking";
  EXPECT_EQ(fate({4}, map_of({{3, 5}})), vanished);
  EXPECT_EQ(fate({1, 2, 3, 4}, map_of({{1, 2}, {8}})), vanished) << "half in a smaller one";
  EXPECT_EQ(fate({1, 2, 3, 4}, map_of({{1, 2, 5, 6, 7}})), neither) << "half is no majority";
  EXPECT_EQ(fate({1, 2}, map_of({{1, 9}, {2}})), neither);
  EXPECT_EQ(fate({1, 2, 3, 4}, map_of({{1, 2}, {3, 4}})), shrank) << "in two pieces";
  EXPECT_EQ(fate(grain_ids(0, 4), map_of({{0, 1, 10, 11, 12}, {2, 3, 20, 21, 22}})), grew)
      << "in two larger ones";
}

TEST(Follow, BothOfTwoThatMergeGrow) {
  GrowthBySize counts;
  follow(map_of({{1, 2, 3}, {7, 8}}), map_of({{1, 2, 3, 7, 8}}), counts);
  EXPECT_EQ(counts[3].grew, 1U);
  EXPECT_EQ(counts[2].grew, 1U);
  EXPECT_EQ(counts[2].absorbed, 1U);
  EXPECT_EQ(counts[3].absorbed, 0U) << "the larger of both";
}

TEST(GrowthOf, PairsAreTheStatedCyclesApart) {
  FigureRun run = made_up_run("fluid", "still", 1, 3, [](int, Measures&) {});
  for (CheckpointMeasures& c : run.checkpoints) {
    c.measures.crystallite_map = map_of({grain_ids(0, 2 + static_cast<std::int32_t>(c.cycle))});
  }
  const GrowthBySize two = growth_of(run, 2);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two.at(2).grew + two.at(3).grew, 2U);
  EXPECT_TRUE(growth_of(run, 4).empty());
  run.checkpoints.erase(run.checkpoints.begin() + 2);
  EXPECT_EQ(growth_of(run, 2).size(), 1U) << "a pruned cycle makes no other pair";
}

TEST(GrowthRates, HaveBinomialErrors) {
  GrowthBySize a = {{5, {3, 1, 0}}};
  const GrowthBySize b = {{5, {0, 12, 0}}, {6, {0, 0, 0}}};
  const std::vector<GrowthRate> rates = growth_rates(std::vector{a, b});
  ASSERT_EQ(rates.size(), 1U) << "a size that only stays has no probability";
  EXPECT_DOUBLE_EQ(rates[0].size, 5);
  EXPECT_EQ(rates[0].counted, 16U);
  EXPECT_DOUBLE_EQ(rates[0].grow, 3.0 / 16);
  EXPECT_DOUBLE_EQ(rates[0].delta, -10.0 / 16);
  EXPECT_DOUBLE_EQ(rates[0].grow_error, std::sqrt(4.0 * 14 / (18 * 18 * 19)));
  EXPECT_DOUBLE_EQ(rates[0].delta_error, 2 * rates[0].grow_error);
  a[7] = {1, 0, 0};
  EXPECT_GT(growth_rates(std::vector{a}).back().grow_error, 0.2) << "one case is no certainty";
}

/// P(grow) is logistic in ln(size), with counts that fall as sizes do.
GrowthBySize logistic_growth(double critical, double slope, double scale = 1e6) {
  GrowthBySize counts;
  for (std::int32_t size = 1; size <= 60; ++size) {
    const double n = scale / (size * size);
    const double grow = 1 / (1 + std::pow(critical / size, slope));
    counts[size].grew = static_cast<std::size_t>(std::lround(n * grow));
    counts[size].shrank = static_cast<std::size_t>(std::lround(n * (1 - grow)));
  }
  return counts;
}

TEST(GrowthFit, TwoSizesAreFittedExactly) {
  const GrowthBySize counts = {{4, {1, 3, 0}}, {16, {3, 1, 0}}};
  const GrowthFit fit = fit_growth(std::vector{counts}).value();
  EXPECT_NEAR(fit.critical_size().value(), 8, 1e-9);
  EXPECT_NEAR(fit.slope, 2 * std::log(3.0) / std::log(4.0), 1e-9);
  EXPECT_NEAR(fit.delta_rho(4), -0.5, 1e-9);
  EXPECT_NEAR(fit.delta_rho(8), 0, 1e-9);
}

TEST(GrowthFit, FindsTheCurveThatMadeTheCounts) {
  for (const double critical : {10.0, 13.4, 16.0, 20.0}) {
    const GrowthFit fit = fit_growth(std::vector{logistic_growth(critical, 1.5)}).value();
    EXPECT_NEAR(fit.critical_size().value(), critical, 0.02 * critical);
    EXPECT_NEAR(fit.slope, 1.5, 0.01);
  }
}

// Newton's method alone leaves these maxima, which scipy finds too, and does not come back.
TEST(GrowthFit, FindsTheMaximumOfFewCrystallites) {
  const auto fit = [](const GrowthBySize& counts) {
    return fit_growth(std::vector{counts}).value();
  };
  const GrowthFit few = fit({{1, {0, 32, 0}},
                             {2, {0, 7, 0}},
                             {3, {0, 3, 0}},
                             {4, {0, 2, 0}},
                             {16, {0, 1, 0}},
                             {29, {0, 1, 0}},
                             {65, {1, 0, 0}},
                             {78, {0, 1, 0}}});
  EXPECT_NEAR(few.slope, 2.58, 0.01);
  EXPECT_NEAR(few.critical_size().value(), 76.7, 0.1);
  const GrowthFit more = fit({{1, {0, 17, 0}},
                              {2, {0, 7, 0}},
                              {3, {0, 4, 0}},
                              {4, {0, 3, 0}},
                              {5, {0, 2, 0}},
                              {12, {0, 1, 0}},
                              {13, {0, 1, 0}},
                              {19, {0, 1, 0}},
                              {41, {1, 0, 0}},
                              {67, {1, 0, 0}},
                              {95, {0, 1, 0}}});
  EXPECT_NEAR(more.slope, 1.91, 0.01);
  EXPECT_NEAR(more.critical_size().value(), 55.0, 0.1);
}

TEST(GrowthFit, IsMissingWithoutATurn) {
  const auto fit = [](const GrowthBySize& counts) { return fit_growth(std::vector{counts}); };
  EXPECT_FALSE(fit({{3, {0, 9, 0}}}).has_value()) << "all shrink";
  EXPECT_FALSE(fit({{3, {4, 9, 0}}}).has_value()) << "one size";
  EXPECT_FALSE(fit({{3, {4, 9, 0}}, {9, {1, 9, 0}}})->critical_size()) << "falls with size";
  EXPECT_FALSE(fit_growth({}).has_value());
  const double between = fit({{3, {0, 9, 0}}, {9, {9, 0, 0}}})->critical_size().value();
  EXPECT_GT(between, 3) << "sizes that do not mix";
  EXPECT_LT(between, 9);
}

TEST(GrowthFit, VanishedOnesMayBeLeftOut) {
  const GrowthBySize counts = {{4, {1, 6, 3}}, {16, {3, 1, 0}}};
  const std::vector<GrowthBySize> runs(least_bootstrap_runs, counts);
  EXPECT_NEAR(critical_size(runs, Vanished::left_out)->value, 8, 1e-9);
  EXPECT_GT(fit_growth(std::vector{counts})->critical_size().value(), 8);
}

TEST(CriticalSize, IntervalComesFromTheRuns) {
  std::vector<GrowthBySize> runs;
  for (const double size : {14, 15, 16, 14, 15, 16}) runs.push_back(logistic_growth(size, 2));
  const Estimate found = critical_size(runs).value();
  EXPECT_NEAR(found.value, 15, 0.3);
  // Student's interval of the mean of these six: +- 2.015 sqrt(0.8 / 6).
  EXPECT_NEAR(found.interval.high - found.interval.low, 2 * 2.015 * std::sqrt(0.8 / 6), 0.4);
  EXPECT_EQ(found.runs, 6U);
  EXPECT_FALSE(critical_size(std::span(runs).first(4)).has_value());
  const GrowthBySize nearly_flat = {{1, {600, 400, 0}}, {10, {601, 399, 0}}};
  EXPECT_LT(fit_growth(std::vector{nearly_flat})->critical_size().value(), 1);
  EXPECT_FALSE(critical_size(std::vector(5, nearly_flat)).has_value()) << "less than a grain";
  const Estimate band = fitted_delta_rho(runs, std::array{15.0}).front().value();
  EXPECT_LT(band.interval.low, 0);
  EXPECT_GT(band.interval.high, 0);
}

// An unbounded end would leave the whole band out of the drawing.
TEST(FittedDeltaRho, IsUnknownIfManySelectionsHaveNoFit) {
  std::vector<GrowthBySize> runs(5, GrowthBySize{{3, {0, 9, 0}}, {9, {0, 4, 0}}});
  runs[0] = logistic_growth(15, 2);
  const Estimate band = fitted_delta_rho(runs, std::array{15.0}).front().value();
  EXPECT_EQ(band.interval.low, -1);
  EXPECT_EQ(band.interval.high, 1);
}

TEST(MonotoneCriticalSize, IsWhereTheShareThatGrowsPassesAHalf) {
  const auto size = [](const GrowthBySize& counts) {
    return monotone_critical_size(std::vector(5, counts));
  };
  EXPECT_EQ(size({{1, {1, 9, 0}}, {2, {4, 6, 0}}, {3, {3, 7, 0}}, {5, {8, 2, 0}}})->value, 5);
  EXPECT_EQ(size({{1, {1, 9, 0}}, {2, {7, 3, 0}}, {3, {4, 6, 0}}, {5, {8, 2, 0}}})->value, 2)
      << "2 and 3 together: 11 of 20";
  EXPECT_FALSE(size({{1, {6, 4, 0}}, {2, {7, 3, 0}}}).has_value()) << "all sizes grow";
  EXPECT_FALSE(size({{5, {3, 0, 0}}, {6, {3, 0, 0}}}).has_value()) << "and no smaller ones";
  EXPECT_FALSE(size({{1, {4, 6, 0}}, {2, {5, 5, 0}}}).has_value()) << "none grows";
  std::vector<GrowthBySize> runs;
  for (int run = 0; run < 6; ++run) runs.push_back(logistic_growth(15, 2));
  EXPECT_NEAR(monotone_critical_size(runs)->value, 15, 1.1);
}

TEST(GrowthRates, OfBinsLeaveOutRareSizes) {
  const GrowthBySize counts = {{1, {1, 9, 0}}, {2, {2, 4, 0}}, {8, {4, 2, 0}}, {50, {1, 0, 0}}};
  const std::vector<GrowthRate> bins = growth_rates(std::vector{counts}, 10);
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_DOUBLE_EQ(bins[0].delta, -0.8);
  EXPECT_NEAR(bins[1].size, 4, 1e-12) << "six of 2 and six of 8 grains";
  EXPECT_DOUBLE_EQ(bins[1].delta, 0);
  EXPECT_DOUBLE_EQ(bins[1].delta_error, 2 * std::sqrt(7.0 * 7 / 15) / 14);
}

}  // namespace
}  // namespace shearcell::test
