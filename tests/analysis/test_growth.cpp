// SPDX-License-Identifier: GPL-3.0-or-later
// Crystallites with known fates: growth, merging, breaking, vanishing, ties.
#include "analysis/growth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::testing {
namespace {

std::vector<std::int32_t> grains(std::int32_t first, std::int32_t count) {
  std::vector<std::int32_t> ids(static_cast<std::size_t>(count));
  std::iota(ids.begin(), ids.end(), first);
  return ids;
}

GrowthCount fate(const std::vector<std::int32_t>& crystallite, const CrystalliteMap& later) {
  GrowthBySize counts;
  follow(map_of({crystallite}), later, counts);
  EXPECT_EQ(counts.size(), 1U);
  return counts[static_cast<std::int32_t>(crystallite.size())];
}

TEST(Follow, TheMajorityDecides) {
  EXPECT_EQ(fate({1, 2, 3}, map_of({{1, 2, 7, 8}})).grew, 1U) << "two of three in a larger one";
  EXPECT_EQ(fate({1, 2, 3}, map_of({{1, 7, 8, 9}})).shrank, 1U) << "one of three";
  EXPECT_EQ(fate({1, 2, 3}, map_of({{1, 2}})).shrank, 1U);
  EXPECT_EQ(fate({1, 2, 3}, map_of({{2, 3, 9}})).same, 1U);
}

TEST(Follow, VanishingIsShrinking) {
  EXPECT_EQ(fate({4, 5}, map_of({})).shrank, 1U);
  EXPECT_EQ(fate({4}, map_of({{3, 5}})).vanished, 1U);
  EXPECT_EQ(fate({1, 2, 3, 4}, map_of({{1, 2}, {8}})).vanished, 1U) << "half in a smaller one";
  EXPECT_EQ(fate({1, 2, 3}, map_of({{1, 2}})).vanished, 0U) << "most are in a smaller one";
}

TEST(Follow, HalfIsNoMajority) {
  EXPECT_EQ(fate({1, 2, 3, 4}, map_of({{1, 2, 5, 6, 7}})).undecided, 1U);
  EXPECT_EQ(fate({1, 2}, map_of({{1, 9}, {2}})).undecided, 1U);
}

TEST(Follow, BreakingInPiecesIsShrinkingAndTwoLargerOnesAreGrowth) {
  EXPECT_EQ(fate({1, 2, 3, 4}, map_of({{1, 2}, {3, 4}})).shrank, 1U);
  EXPECT_EQ(fate(grains(0, 4), map_of({{0, 1, 10, 11, 12}, {2, 3, 20, 21, 22}})).grew, 1U);
}

TEST(Follow, BothOfTwoThatMergeGrow) {
  GrowthBySize counts;
  follow(map_of({{1, 2, 3}, {7, 8}}), map_of({{1, 2, 3, 7, 8}}), counts);
  EXPECT_EQ(counts[3].grew, 1U);
  EXPECT_EQ(counts[2].grew, 1U);
}

TEST(GrowthOf, PairsAreTheStatedCyclesApart) {
  FigureRun run = made_up_run("fluid", "still", 1, 3, [](int, Measures&) {});
  for (CheckpointMeasures& c : run.checkpoints) {
    c.crystallites = map_of({grains(0, 2 + static_cast<std::int32_t>(c.cycle))});
  }
  const GrowthBySize two = growth_of(run, 2);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two.at(2).grew + two.at(3).grew, 2U);
  EXPECT_TRUE(growth_of(run, 4).empty());
  run.checkpoints.erase(run.checkpoints.begin() + 2);
  EXPECT_EQ(growth_of(run, 2).size(), 1U) << "a pruned cycle makes no other pair";
}

TEST(GrowthRates, HaveBinomialErrors) {
  GrowthBySize a, b;
  a[5] = {3, 1, 10, 10};
  b[5] = {0, 12, 0, 0};
  b[6] = {0, 0, 4, 0};
  const std::vector<GrowthRate> rates = growth_rates(std::vector{a, b});
  ASSERT_EQ(rates.size(), 1U) << "a size that only stays has no probability";
  EXPECT_EQ(rates[0].counted, 16U);
  EXPECT_DOUBLE_EQ(rates[0].grow, 3.0 / 16);
  EXPECT_DOUBLE_EQ(rates[0].delta, -10.0 / 16);
  EXPECT_DOUBLE_EQ(rates[0].grow_error, std::sqrt(4.0 * 14 / (18 * 18 * 19)));
  EXPECT_DOUBLE_EQ(rates[0].delta_error, 2 * rates[0].grow_error);
  a[7] = {1, 0, 0, 0};
  EXPECT_GT(growth_rates(std::vector{a}).back().grow_error, 0.2) << "one case is no certainty";
}

}  // namespace
}  // namespace shearcell::testing
