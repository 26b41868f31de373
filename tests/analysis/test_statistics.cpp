// SPDX-License-Identifier: GPL-3.0-or-later
// Errors, intervals and numbers of runs compared with closed forms and tables. Survival: the
// remission times of Freireich et al., Blood 21, 699 (1963), whose Kaplan-Meier estimate and
// log-rank statistic are in every textbook of survival analysis; and scaled copies of these times.
#include "analysis/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::test {
namespace {

TEST(OverRuns, MeanAndStandardError) {
  const RunStatistics s = over_runs(std::vector<double>{1, 2, std::nan(""), 3, 6});
  EXPECT_EQ(s.runs, 4U);
  EXPECT_DOUBLE_EQ(s.mean.value(), 3);
  EXPECT_DOUBLE_EQ(s.standard_error.value(), std::sqrt(14.0 / 12));
  const RunStatistics one = over_runs(std::vector<double>{0.64});
  EXPECT_EQ(one.mean.value(), 0.64);
  EXPECT_FALSE(one.standard_error.has_value());
  const RunStatistics none = over_runs(std::vector<double>{std::nan("")});
  EXPECT_EQ(none.runs, 0U);
  EXPECT_FALSE(none.mean.has_value());
}

std::optional<double> bootstrap_of_mean(const std::vector<double>& values) {
  return bootstrap_error(values.size(), mean_over(values));
}

TEST(RunStatistics, OfRootMeanSquares) {
  const RunStatistics s = rms_over_runs(std::vector<double>{1, -2, std::nan(""), 2});
  EXPECT_EQ(s.runs, 3U);
  EXPECT_DOUBLE_EQ(s.mean.value(), std::sqrt(3));
  EXPECT_DOUBLE_EQ(s.standard_error.value(), 1 / (2 * std::sqrt(3)));  // of 1, 4, 4: 3 +- 1
  const RunStatistics zero = rms_over_runs(std::vector<double>{0, 0});
  EXPECT_EQ(zero.mean, 0);
  EXPECT_EQ(zero.standard_error, 0);
  EXPECT_FALSE(rms_over_runs(std::vector<double>{-3}).standard_error);
  EXPECT_EQ(rms_over_runs(std::vector<double>{-3}).mean, 3);
  EXPECT_FALSE(rms_over_runs(std::vector<double>{}).mean);
  // The error is that of many samples of 100 values.
  std::vector<double> roots, errors;
  for (std::uint32_t sample = 0; sample < 400; ++sample) {
    const RunStatistics one = rms_over_runs(normal_numbers(sample, 100));
    roots.push_back(one.mean.value());
    errors.push_back(one.standard_error.value());
  }
  const double spread = over_runs(roots).standard_error.value() * std::sqrt(400);
  std::printf("spread of the roots %.4f, mean error %.4f\n", spread,
              over_runs(errors).mean.value());
  EXPECT_NEAR(over_runs(errors).mean.value() / spread, 1, 0.1);
}

TEST(Bootstrap, OfAMeanIsItsStandardError) {
  const std::vector<double> values = normal_numbers(0, 10);
  EXPECT_NEAR(bootstrap_of_mean(values).value() / over_runs(values).standard_error.value(), 1,
              0.08);
  EXPECT_EQ(bootstrap_of_mean(values), bootstrap_of_mean(values));
}

TEST(Bootstrap, CoversTheTrueMeanAsOftenAsStated) {
  constexpr std::uint32_t samples = 400;
  constexpr std::size_t runs = 8;
  const double limit = student_quantile(0.97725, runs - 1);
  std::uint32_t covered = 0;
  for (std::uint32_t s = 0; s < samples; ++s) {
    const std::vector<double> values = normal_numbers(s, runs);
    const double mean = over_runs(values).mean.value();
    covered += std::abs(mean) < limit * bootstrap_of_mean(values).value() ? 1U : 0U;
  }
  const double share = static_cast<double>(covered) / samples;
  std::printf("covered %.3f, expected 0.954 +- 0.010\n", share);
  EXPECT_NEAR(share, 0.9545, 0.035);
}

TEST(Bootstrap, NeedsTwoRunsAndAStatistic) {
  const auto none = [](std::span<const std::size_t>) { return std::nan(""); };
  EXPECT_FALSE(bootstrap_of_mean({1}).has_value());
  EXPECT_FALSE(bootstrap_error(5, none).has_value());
}

double half_length(const Estimate& estimate) {
  return (estimate.interval.high - estimate.interval.low) / 2;
}

TEST(Quantiles, AgreeWithTables) {
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

TEST(Bootstrapped, InfiniteValuesMoveOneEndOnly) {
  const std::vector<double> values = {0, 0, 0, 1, 1, 1};
  const auto half = [&](std::span<const std::size_t> selection) {
    const double mean = mean_over(values)(selection);
    return mean > 0.7 ? std::numeric_limits<double>::infinity() : mean;
  };
  const Estimate found = bootstrapped(6, half).value();
  EXPECT_TRUE(std::isinf(found.interval.high));
  EXPECT_EQ(found.interval.low, bootstrapped(6, mean_over(values))->interval.low);
  EXPECT_TRUE(bootstrap_error(6, half).has_value());
}

TEST(Bootstrapped, SelectionsWithoutAValueWidenIt) {
  const std::vector<double> values = {0, 0, 0, 1, 1, 1};
  const Estimate found = bootstrapped(6, [&](std::span<const std::size_t> selection) {
                           const double mean = mean_over(values)(selection);
                           return mean < 0.3 ? std::nan("") : mean;
                         }).value();
  EXPECT_TRUE(std::isinf(found.interval.low) && std::isinf(found.interval.high));
  EXPECT_FALSE(runs_to_resolve(found, 1, true).has_value());
  EXPECT_FALSE(bootstrapped(6, [](auto) { return std::nan(""); }).has_value());
}

TEST(Levels, AreThoseOfTheQuantile) {
  const std::vector<double> a = {1, 2, 3, 6}, b = {2, 2.5, 1, 0};
  const auto ratio = [](const Estimate& at_96, const Estimate& at_90) {
    return half_length(at_96) / half_length(at_90);
  };
  EXPECT_NEAR(ratio(*mean_of(a, 0.96), *mean_of(a)), 3.4819088 / 2.3533634, 1e-6);
  EXPECT_GT(ratio(*difference_of_means(a, b, 0.96), *difference_of_means(a, b)), 1.2);
  const std::vector<double> values = normal_numbers(1, 10);
  EXPECT_GT(ratio(*bootstrapped(10, mean_over(values), 0.96), *bootstrapped(10, mean_over(values))),
            1.1);
}

TEST(VarianceBetween, IsThatOfTheAnalysisOfVariance) {
  // F: scipy.stats.f_oneway. Limit: quantiles of scipy.stats.
  const std::vector<std::vector<double>> groups = {
      {1, 2, 3, 4}, {3, 5, 4}, {6, 8, 7, 7, 9}, {2, 4}, {}};
  const SpreadBetween found = variance_between(groups).value();
  EXPECT_NEAR(found.f, 14.792085848, 1e-8);
  EXPECT_NEAR(found.value, 2.406797884, 1e-8);
  EXPECT_NEAR(found.upper_limit, 7.250134925, 1e-8);
  const SpreadBetween same =
      variance_between(std::vector<std::vector<double>>{{1, 3}, {3, 1}, {2, 2}}).value();
  EXPECT_EQ(same.value, 0);
  EXPECT_EQ(same.upper_limit, 0) << "F is below its 5 % quantile";
  EXPECT_FALSE(variance_between(std::vector<std::vector<double>>{{1, 2}, {}}));
  EXPECT_FALSE(variance_between(std::vector<std::vector<double>>{{1}, {2}, {3}}));
}

TEST(VarianceBetween, TheUpperLimitExceedsTheTruthInNineteenOfTwentySamples) {
#ifdef NDEBUG
  constexpr std::uint32_t samples = 4000;
#else
  constexpr std::uint32_t samples = 1000;
#endif
  std::printf(
      "| group sizes | true | mean of the estimate's square | above the truth "
      "|\n|---|---|---|---|\n");
  for (const std::vector<std::size_t>& sizes :
       {std::vector<std::size_t>(6, 10), {4, 12, 10, 6, 20}}) {
    for (const double truth : {0.0, 0.3, 1.0, 5.0}) {
      std::uint32_t held = 0;
      double squares = 0;
      for (std::uint32_t s = 0; s < samples; ++s) {
        const std::vector<double> means = normal_numbers(2 * s, sizes.size());
        const std::vector<double> noise = normal_numbers(2 * s + 1, 60);
        std::vector<std::vector<double>> groups;
        std::size_t next = 0;
        for (std::size_t k = 0; k < sizes.size(); ++k) {
          std::vector<double> group;
          while (group.size() < sizes[k]) group.push_back(0.646 + truth * means[k] + noise[next++]);
          groups.push_back(group);
        }
        const SpreadBetween found = variance_between(groups).value();
        held += found.upper_limit >= truth ? 1 : 0;
        squares += found.value * found.value / samples;
      }
      const double share = static_cast<double>(held) / samples;
      std::printf("| %zu groups, %zu to %zu | %.1f | %.3f | %.3f |\n", sizes.size(),
                  *std::ranges::min_element(sizes), *std::ranges::max_element(sizes), truth,
                  squares, share);
      EXPECT_GE(share, 0.94 - 3 * std::sqrt(0.95 * 0.05 / samples));
      EXPECT_NEAR(squares, truth * truth, 0.1 * truth * truth + 0.1);
    }
  }
}

TEST(Repetitions, OfAMeanScatterAsItsError) {
  const std::vector<double> values = normal_numbers(3, 400);
  const auto [low, high] = repetitions(values.size(), 16, mean_over(values));
  const RunStatistics all = over_runs(values);
  const double error = *all.standard_error * std::sqrt(400.0 / 16);
  EXPECT_NEAR(low, *all.mean - 1.645 * error, 0.1 * error);
  EXPECT_NEAR(high, *all.mean + 1.645 * error, 0.1 * error);
  EXPECT_TRUE(std::isinf(repetitions(4, 16, mean_over(values)).low)) << "too few runs";
}

TEST(RelativeDifference, AddsTheErrorsThatMoveItThere) {
  const Estimate a = {.value = 20, .interval = {20 * std::exp(-0.3), 40}, .runs = 7, .spread = 3};
  const Estimate b = {.value = 10, .interval = {5, 10 * std::exp(0.4)}, .runs = 9};
  const Estimate found = relative_difference(a, b).value();
  EXPECT_DOUBLE_EQ(found.value, 1);
  EXPECT_NEAR(found.interval.low, 2 * std::exp(-0.5) - 1, 1e-12);
  EXPECT_NEAR(found.interval.high, 2 * std::exp2(std::sqrt(2.0)) - 1, 1e-12);
  EXPECT_EQ(found.runs, 7U);
  EXPECT_NEAR(found.spread, 0.3, 1e-12);
  const Estimate unbounded = {.value = 20, .interval = {-infinite, 40}};
  EXPECT_EQ(relative_difference(unbounded, b)->interval.low, -1);
  EXPECT_EQ(relative_difference(a, unbounded)->interval.high, infinite);
  EXPECT_FALSE(relative_difference(a, {}) || relative_difference({}, b));
}

double coverage_of_bootstrap(std::size_t runs) {
  constexpr std::uint32_t samples = 400;
  std::uint32_t covered = 0;
  for (std::uint32_t s = 0; s < samples; ++s) {
    const auto found = bootstrapped(runs, mean_over(normal_numbers(s, runs)));
    if (!found) return std::nan("");
    covered += found->interval.low <= 0 && found->interval.high >= 0 ? 1U : 0U;
  }
  return static_cast<double>(covered) / samples;
}

TEST(Bootstrapped, CoversTheTrueMeanAsOftenAsStatedOrHasNoInterval) {
  for (const std::size_t runs : {2U, 3U, 4U}) EXPECT_TRUE(std::isnan(coverage_of_bootstrap(runs)));
  for (const std::size_t runs : {5U, 6U, 8U}) {
    const double share = coverage_of_bootstrap(runs);
    std::printf("%zu runs: covered %.3f, expected %.3f +- 0.015\n", runs, share, confidence_level);
    EXPECT_NEAR(share, confidence_level, 0.045) << runs;
  }
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

std::vector<CensoredValue> waits(std::initializer_list<double> cycles) {  // negative: censored
  std::vector<CensoredValue> runs;
  for (const double cycle : cycles) runs.push_back({std::abs(cycle), cycle <= 0});
  return runs;
}

const std::vector<CensoredValue> treated = waits(
    {6, 6, 6, -6, 7, -9, 10, -10, -11, 13, 16, -17, -19, -20, 22, 23, -25, -32, -32, -34, -35});
const std::vector<CensoredValue> untreated =
    waits({1, 1, 2, 2, 3, 4, 4, 5, 5, 8, 8, 8, 8, 11, 11, 12, 12, 15, 17, 22, 23});

std::vector<CensoredValue> scaled(std::vector<CensoredValue> runs, double factor) {
  for (CensoredValue& run : runs) run.value *= factor;
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
  EXPECT_EQ(median_wait(waits({2, 3, 7, 9})), 5) << "the middle of an even number";
  EXPECT_EQ(median_wait(waits({2, 3, -7, -9})), 3) << "no later event";
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

/// The share of samples of equal groups whose interval contains the ratio 1.
double coverage(std::size_t runs, double longest) {
  constexpr std::uint32_t samples = 2000;
  const auto sample = [&](std::uint32_t id) {
    std::vector<CensoredValue> waits;
    for (const double value : normal_numbers(id, runs)) {
      const double cycle = 20 * std::exp(0.6 * value);
      waits.push_back({std::min(cycle, longest), cycle > longest});
    }
    return waits;
  };
  std::uint32_t covered = 0;
  for (std::uint32_t k = 0; k < samples; ++k) {
    const Estimate found = log2_wait_ratio(sample(2 * k), sample(2 * k + 1)).value();
    covered += found.interval.low <= 0 && found.interval.high >= 0 ? 1 : 0;
  }
  return static_cast<double>(covered) / samples;
}

TEST(WaitRatio, TheIntervalCoversTheTruthInNineOfTenSamples) {
  for (const std::size_t runs : {4U, 6U, 12U}) {
    for (const double longest : {1e3, 40.0}) {
      const double found = coverage(runs, longest);
      std::printf("%zu runs a group, censored at %g: coverage %.3f\n", runs, longest, found);
      EXPECT_NEAR(found, 0.9, 0.03);
    }
  }
}

TEST(WaitRatio, NeedsEvents) {
  EXPECT_FALSE(log2_wait_ratio(waits({-3, -4, -5}), waits({-3, -4, -5})).has_value());
  EXPECT_FALSE(log2_wait_ratio(waits({3, 4}), waits({3, 4, 5})).has_value());
  const Estimate one = log2_wait_ratio(waits({3, -4, -5}), waits({-3, -4, -5})).value();
  EXPECT_TRUE(std::isinf(one.interval.low) && std::isinf(one.interval.high));
}

}  // namespace
}  // namespace shearcell::test
