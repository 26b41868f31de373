// SPDX-License-Identifier: GPL-3.0-or-later
// The remission times of Freireich et al., Blood 21, 699 (1963), whose Kaplan-Meier estimate and
// log-rank statistic are in every textbook of survival analysis; scaled copies.
#include "analysis/survival.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace shearcell {
namespace {

std::vector<Waiting> waits(std::initializer_list<double> cycles) {  // negative: censored
  std::vector<Waiting> runs;
  for (const double cycle : cycles) runs.push_back({std::abs(cycle), cycle > 0});
  return runs;
}

const std::vector<Waiting> treated = waits(
    {6, 6, 6, -6, 7, -9, 10, -10, -11, 13, 16, -17, -19, -20, 22, 23, -25, -32, -32, -34, -35});
const std::vector<Waiting> untreated =
    waits({1, 1, 2, 2, 3, 4, 4, 5, 5, 8, 8, 8, 8, 11, 11, 12, 12, 15, 17, 22, 23});

std::vector<Waiting> scaled(std::vector<Waiting> runs, double factor) {
  for (Waiting& run : runs) run.cycle *= factor;
  return runs;
}

TEST(KaplanMeier, OfTheRemissionTimes) {
  const std::vector<SurvivalStep> steps = kaplan_meier(treated);
  const std::vector<double> expected = {0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448};
  ASSERT_EQ(steps.size(), expected.size());
  for (std::size_t k = 0; k < steps.size(); ++k) {
    EXPECT_NEAR(steps[k].survival, expected[k], 5e-4) << steps[k].cycle;
  }
  EXPECT_EQ(median_wait(treated), 23);
  EXPECT_EQ(median_wait(untreated), 8);
  EXPECT_FALSE(median_wait(waits({3, -4, -5})).has_value());
}

TEST(LogRank, OfTheRemissionTimes) {
  const double z = log_rank(untreated, treated);
  EXPECT_NEAR(z * z, 16.79, 0.01);
  EXPECT_GT(z, 0) << "the untreated relapse earlier";
  EXPECT_DOUBLE_EQ(log_rank(treated, untreated), -z);
  EXPECT_EQ(log_rank(waits({-3, -4}), waits({-5})), 0);
}

TEST(WaitRatio, IsTheFactorBetweenTheGroups) {
  const Estimate same = log2_wait_ratio(untreated, untreated).value();
  EXPECT_NEAR(same.value, 0, 0.15);
  EXPECT_LT(same.interval.low, 0);
  EXPECT_GT(same.interval.high, 0);
  const Estimate longer = log2_wait_ratio(scaled(untreated, 4), untreated).value();
  EXPECT_NEAR(longer.value, same.value + 2, 1e-9);
  EXPECT_NEAR(longer.interval.low, same.interval.low + 2, 1e-9);
  const Estimate drug = log2_wait_ratio(treated, untreated).value();
  std::printf("remission lasts 2^%.2f times as long, interval %.2f to %.2f\n", drug.value,
              drug.interval.low, drug.interval.high);
  EXPECT_GT(drug.interval.low, 0);
}

TEST(WaitRatio, NeedsEvents) {
  EXPECT_FALSE(log2_wait_ratio(waits({-3, -4, -5}), waits({-3, -4, -5})).has_value());
  EXPECT_FALSE(log2_wait_ratio(waits({3, 4}), waits({3, 4, 5})).has_value());
  const Estimate one = log2_wait_ratio(waits({3, -4, -5}), waits({-3, -4, -5})).value();
  EXPECT_TRUE(std::isinf(one.interval.low) && std::isinf(one.interval.high));
}

}  // namespace
}  // namespace shearcell
