// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "analysis/agreement.hpp"
#include "analysis/statistics.hpp"
#include "core/random.hpp"

namespace shearcell {
namespace {

TEST(OverRuns, MeanAndStandardError) {
  const RunStatistics s = over_runs(std::vector<double>{1, 2, 3, 6});
  EXPECT_EQ(s.runs, 4U);
  EXPECT_DOUBLE_EQ(s.mean.value(), 3);
  EXPECT_DOUBLE_EQ(s.standard_error.value(), std::sqrt(14.0 / 12));
}

TEST(OverRuns, OneRunHasNoError) {
  const RunStatistics s = over_runs(std::vector<double>{0.64});
  EXPECT_EQ(s.mean.value(), 0.64);
  EXPECT_FALSE(s.standard_error.has_value());
}

TEST(OverRuns, NothingMeasured) {
  const RunStatistics s = over_runs(std::vector<double>{std::nan("")});
  EXPECT_EQ(s.runs, 0U);
  EXPECT_FALSE(s.mean.has_value());
}

/// Normal numbers of mean 0 and variance 1, by Box and Muller.
std::vector<double> normal_sample(std::uint32_t sample, std::size_t count) {
  std::vector<double> values;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto [u, v] = uniform_pair({sample, k, 0, 1}, 7);
    values.push_back(std::sqrt(-2 * std::log1p(-u)) * std::cos(2 * std::numbers::pi * v));
  }
  return values;
}

std::optional<double> bootstrap_of_mean(const std::vector<double>& values) {
  return bootstrap_error(values.size(), [&](std::span<const std::size_t> selection) {
    std::vector<double> selected;
    for (const std::size_t k : selection) selected.push_back(values[k]);
    return over_runs(selected).mean;
  });
}

TEST(Bootstrap, OfAMeanIsItsStandardError) {
  const std::vector<double> values = normal_sample(0, 10);
  EXPECT_NEAR(bootstrap_of_mean(values).value() / over_runs(values).standard_error.value(), 1,
              0.08);
  EXPECT_EQ(bootstrap_of_mean(values), bootstrap_of_mean(values));
}

TEST(Bootstrap, CoversTheTrueMeanAsOftenAsItSays) {
  constexpr std::uint32_t samples = 400;
  constexpr std::size_t runs = 8;
  const double limit = limit_of_agreement(runs - 1);
  std::uint32_t covered = 0;
  for (std::uint32_t s = 0; s < samples; ++s) {
    const std::vector<double> values = normal_sample(s, runs);
    const double mean = over_runs(values).mean.value();
    covered += std::abs(mean) < limit * bootstrap_of_mean(values).value() ? 1U : 0U;
  }
  const double share = static_cast<double>(covered) / samples;
  std::printf("covered %.3f, expected 0.954 +- 0.010\n", share);
  EXPECT_NEAR(share, 0.9545, 0.035);
}

TEST(Bootstrap, NeedsTwoRunsAndAStatistic) {
  const auto none = [](std::span<const std::size_t>) { return std::optional<double>(); };
  EXPECT_FALSE(bootstrap_of_mean({1}).has_value());
  EXPECT_FALSE(bootstrap_error(5, none).has_value());
}

TEST(Agreement, LimitIsTwoStandardErrorsForManyRuns) {
  EXPECT_NEAR(limit_of_agreement(1000000), 2, 1e-3);
  EXPECT_NEAR(limit_of_agreement(4), 2.869, 1e-3);  // tables of Student's t
  EXPECT_GT(limit_of_agreement(4, 6), limit_of_agreement(4));
}

TEST(Agreement, DifferenceInStandardErrors) {
  const RunStatistics a{3, 1.0, 0.3};
  const RunStatistics b{5, 2.0, 0.4};
  const RunStatistics single{2, 9.0, 0.1};
  const std::vector<ComparedPoint> points = {{a, b}, {a, a}, {a, single}};
  const CurveDifference found = difference(points, 1e-9);
  EXPECT_EQ(found.points, 2U) << "two runs are too few";
  EXPECT_EQ(found.freedom, 4U);
  EXPECT_DOUBLE_EQ(found.rms.value(), std::sqrt(0.5 * 4));
  EXPECT_DOUBLE_EQ(difference(std::span(points).first(1), 2).rms.value(), 0.5);
  EXPECT_FALSE(difference({}, 1).rms.has_value());
}

}  // namespace
}  // namespace shearcell
