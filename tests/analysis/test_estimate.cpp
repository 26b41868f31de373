// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals and numbers of runs against closed forms and tables.
#include "analysis/estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/analysis/normal_numbers.hpp"

namespace shearcell::testing {
namespace {

double half_length(const Estimate& estimate) {
  return (estimate.interval.high - estimate.interval.low) / 2;
}

RunStatistic mean_over(const std::vector<double>& values) {
  return [&values](std::span<const std::size_t> selection) {
    std::vector<double> selected;
    for (const std::size_t k : selection) selected.push_back(values[k]);
    return over_runs(selected).mean;
  };
}

TEST(Quantiles, AreThoseOfTheTables) {
  EXPECT_NEAR(student_quantile(0.95, 3), 2.353363, 1e-6);
  EXPECT_NEAR(student_quantile(0.95, 5), 2.015048, 1e-6);
  EXPECT_NEAR(normal_quantile(0.95), 1.644854, 1e-6);
}

TEST(MeanOf, HasStudentsInterval) {
  const Estimate found = mean_of(std::vector<double>{1, 2, 3, 6}).value();
  EXPECT_DOUBLE_EQ(found.value, 3);
  EXPECT_NEAR(half_length(found), 2.353363 * std::sqrt(14.0 / 12), 1e-6);
  EXPECT_DOUBLE_EQ(found.spread, std::sqrt(14.0 / 3));
  EXPECT_EQ(found.runs, 4U);
  EXPECT_FALSE(mean_of(std::vector<double>{1, 2}).has_value());
  EXPECT_EQ(half_length(mean_of(std::vector<double>{2, 2, 2}).value()), 0);
}

TEST(DifferenceOfMeans, HasWelchsInterval) {
  const std::vector<double> a = {1, 2, 3}, b = {2, 4, 6};  // variances 1 and 4
  const Estimate found = difference_of_means(a, b).value();
  EXPECT_DOUBLE_EQ(found.value, -2);
  EXPECT_NEAR(half_length(found), student_quantile(0.95, 50.0 / 17) * std::sqrt(5.0 / 3), 1e-12);
  EXPECT_DOUBLE_EQ(found.spread, std::sqrt(5.0));
  EXPECT_EQ(found.groups, 2U);
  EXPECT_FALSE(difference_of_means(a, std::vector<double>{1, 2}).has_value());
  EXPECT_EQ(half_length(
                difference_of_means(std::vector<double>(3, 1), std::vector<double>(3, 2)).value()),
            0);
}

TEST(Bootstrapped, HasTheLengthOfStudentsIntervalForAMean) {
  for (const std::size_t runs : {6U, 10U, 20U}) {
    const std::vector<double> values = normal_numbers(1, runs);
    const Estimate found = bootstrapped(runs, mean_over(values)).value();
    EXPECT_NEAR(half_length(found) / half_length(mean_of(values).value()), 1, 0.15) << runs;
    EXPECT_DOUBLE_EQ(found.value, mean_of(values)->value);
  }
}

TEST(Bootstrapped, SelectionsWithoutAValueWidenIt) {
  const std::vector<double> values = {0, 0, 0, 1, 1, 1};
  const Estimate found =
      bootstrapped(6, [&](std::span<const std::size_t> selection) -> std::optional<double> {
        const auto mean = mean_over(values)(selection);
        return *mean < 0.3 ? std::nullopt : mean;
      }).value();
  EXPECT_TRUE(std::isinf(found.interval.low) && std::isinf(found.interval.high));
  EXPECT_FALSE(runs_to_resolve(found, 1, true).has_value());
  EXPECT_FALSE(bootstrapped(6, [](auto) { return std::optional<double>(); }).has_value());
  EXPECT_FALSE(bootstrapped(2, mean_over(values)).has_value());
}

TEST(RunsToResolve, SolvesTheFormulaOfTheSampleSize) {
  Estimate one{0, {}, 5, 1, 1};
  // 2 t(0.95, n - 1) <= sqrt(n): 3.592 > 3.464 for n = 12 and 3.565 < 3.606 for n = 13.
  EXPECT_EQ(runs_to_resolve(one, 1, true), 13U);
  EXPECT_LT(runs_to_resolve(one, 1, false), 13U);
  one.groups = 2;
  EXPECT_EQ(runs_to_resolve(one, 1, true), 12U) << "more degrees of freedom";
  one.spread = 0;
  EXPECT_EQ(runs_to_resolve(one, 1, true), least_runs);
  one.spread = 1;
  EXPECT_FALSE(runs_to_resolve(one, 1e-3, true).has_value());
}

}  // namespace
}  // namespace shearcell::testing
