// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "analysis/estimate.hpp"
#include "analysis/statistics.hpp"
#include "tests/analysis/normal_numbers.hpp"

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

std::optional<double> bootstrap_of_mean(const std::vector<double>& values) {
  return bootstrap_error(values.size(), [&](std::span<const std::size_t> selection) {
    std::vector<double> selected;
    for (const std::size_t k : selection) selected.push_back(values[k]);
    return over_runs(selected).mean;
  });
}

TEST(Bootstrap, OfAMeanIsItsStandardError) {
  const std::vector<double> values = testing::normal_numbers(0, 10);
  EXPECT_NEAR(bootstrap_of_mean(values).value() / over_runs(values).standard_error.value(), 1,
              0.08);
  EXPECT_EQ(bootstrap_of_mean(values), bootstrap_of_mean(values));
}

TEST(Bootstrap, CoversTheTrueMeanAsOftenAsItSays) {
  constexpr std::uint32_t samples = 400;
  constexpr std::size_t runs = 8;
  const double limit = student_quantile(0.97725, runs - 1);
  std::uint32_t covered = 0;
  for (std::uint32_t s = 0; s < samples; ++s) {
    const std::vector<double> values = testing::normal_numbers(s, runs);
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

}  // namespace
}  // namespace shearcell
