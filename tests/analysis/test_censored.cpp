// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates from values of which some are censored, compared with closed forms and with scipy
// (likelihood by scipy.stats, maxima by Nelder and Mead); and how often their 90 % intervals hold
// the true value. Prints the table of analysis/README.md:
//   test_analysis --gtest_filter='CensoredCoverage.*'
#include "analysis/censored.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "analysis/looks.hpp"
#include "analysis/verdict.hpp"
#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::test {
namespace {

using Values = std::vector<CensoredValue>;

/// Negative: censored.
Values values(std::initializer_list<double> numbers) {
  Values all;
  for (const double number : numbers) all.push_back({std::abs(number), number < 0});
  return all;
}

void expect_estimate(const std::optional<Estimate>& found, double value, double low, double high,
                     double within = 1e-6) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value, value, within);
  EXPECT_NEAR(found->interval.low, low, within);
  EXPECT_NEAR(found->interval.high, high, within);
}

const Values some_a = values({1, 2, -4, -3.5, 2.2, 5}),
             some_b = values({0.5, 2.5, 3, -3.2, 1, 3.9});

TEST(Censored, EstimatesAreThoseOfScipy) {
  // 1.7565346 to 5.7245991 of the normal distribution, 1.1388225 to 5.1067013 of Gumbel's.
  expect_estimate(censored_mean(some_a), 3.3881791, 1.1388225, 5.7245991);
  const Values line = values({1, 2, -4, -3.5, 2.2, 5, 6});
  const std::vector<double> x = {0, 1, 1, 2, 2, 3, 4};
  expect_estimate(censored_slope(line, x), 1.1143659, 0.2462722, 1.9199662);
  const Values five(some_b.begin(), some_b.end() - 1);
  const auto difference = censored_difference(some_a, five, false);
  expect_estimate(difference, 1.1987726, -0.8624641, 3.5974935);
  EXPECT_EQ(difference->groups, 2U);
  EXPECT_EQ(difference->runs, 5U);
  const auto paired = censored_difference(some_a, some_b, true);
  expect_estimate(paired, 0.8908852, 0.1150956, 2.2621945);
  EXPECT_EQ(paired->groups, 1U);
  EXPECT_EQ(paired->runs, 6U);
}

void expect_equal(const std::optional<Estimate>& a, const std::optional<Estimate>& b) {
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->value, b->value);
  EXPECT_EQ(a->interval.low, b->interval.low);
  EXPECT_EQ(a->interval.high, b->interval.high);
  EXPECT_EQ(a->spread, b->spread);
  EXPECT_EQ(a->runs, b->runs);
  EXPECT_EQ(a->groups, b->groups);
}

TEST(Censored, WithoutCensoringIntervalsAreThoseOfStudentAndWelch) {
  const std::vector<double> a = {1, 2, 3, 6}, b = {2, 2.5, 1, 0}, less = {-1, -0.5, 2, 6};
  const Values x = values({1, 2, 3, 6}), y = values({2, 2.5, 1, 0});
  expect_equal(censored_mean(x), mean_of(a));
  expect_equal(censored_mean(x, 0.96), mean_of(a, 0.96));
  expect_equal(censored_difference(x, y, false), difference_of_means(a, b));
  expect_equal(censored_difference(x, y, true), mean_of(less));
  // Slope and error: scipy.stats.linregress.
  expect_estimate(
      censored_slope(values({1, 2, 4, 3.5, 2.2, 5, 6}), std::vector<double>{0, 1, 1, 2, 2, 3, 4}),
      1.1407894737, 0.5466733767, 1.7349055707);
}

TEST(Censored, AValueCensoredFarBelowSaysNothing) {
  // But it counts as a run: n = 8 in the threshold of seven observed values.
  const double t = student_quantile(0.95, 6), error = 0.2948396202;
  const double half = error * std::sqrt(5 * std::expm1(8 * std::log1p(t * t / 6) / 7));
  Values line = values({1, 2, 4, 3.5, 2.2, 5, 6});
  line.push_back({-1000, true});
  const std::vector<double> x = {0, 1, 1, 2, 2, 3, 4, 2};
  expect_estimate(censored_slope(line, x), 1.1407894737, 1.1407894737 - half, 1.1407894737 + half);
}

TEST(Censored, UnitsAndZeroDoNotMatter) {
  const auto shifted = [](Values all) {
    for (CensoredValue& one : all) one.value = 0.646 + 1e-4 * one.value;
    return all;
  };
  const auto back = [](Estimate found) { return (found.interval.high - 0.646) / 1e-4; };
  EXPECT_NEAR(back(*censored_mean(shifted(some_a))), 5.7245991, 1e-6);
  const Estimate paired = *censored_difference(shifted(some_a), shifted(some_b), true);
  EXPECT_NEAR(paired.interval.high / 1e-4, 2.2621945, 1e-6);
  const Values line = shifted(values({1, 2, -4, -3.5, 2.2, 5, 6}));
  const std::vector<double> x = {5000, 5001, 5001, 5002, 5002, 5003, 5004};
  EXPECT_NEAR(censored_slope(line, x)->interval.low / 1e-4, 0.2462722, 1e-6);
}

TEST(Censored, FewObservedValuesBoundOneSide) {
  const auto bounds = [](std::initializer_list<double> numbers) {
    const Estimate found = censored_mean(values(numbers)).value();
    EXPECT_EQ(found.value, infinite);
    EXPECT_EQ(found.interval.high, infinite);
    EXPECT_FALSE(runs_to_resolve(found, 1, true));
    return found.interval.low;
  };
  EXPECT_EQ(bounds({-3, -2, -2, -4, -5}), 2) << "1/32 below 5 %";
  EXPECT_EQ(bounds({-3, -2, -2, -4}), -infinite) << "1/16 above 5 %";
  EXPECT_EQ(bounds({1.5, -2, -2, -4, -5}), 1.5);
  EXPECT_EQ(censored_mean(values({-3, -2, -2, -4, -5}), 0.96)->interval.low, -infinite);
  EXPECT_FALSE(censored_mean(values({1, -2})));
  EXPECT_FALSE(censored_mean({}));
  EXPECT_FALSE(censored_difference(values({1, 2, 3}), values({1, -2, -3}), false));
  EXPECT_FALSE(censored_difference(values({1, 2, 3}), values({1, -2, -3}), true));
  EXPECT_FALSE(censored_difference(values({1, -2}), values({1, 2, 3}), false));
  EXPECT_FALSE(censored_slope(values({1, -2, 3}), std::vector<double>{0, 1, 2}));
  EXPECT_FALSE(censored_slope(values({1, 2, 3}), std::vector<double>{1, 1, 1}));
  EXPECT_FALSE(censored_slope({}, {}));
  // Two observed values of six: a wide interval, but a finite one.
  const Estimate two = censored_mean(values({1, 2, -2, -2, -2, -2})).value();
  std::printf("two of six: %.2f (%.2f to %.2f)\n", two.value, two.interval.low, two.interval.high);
  EXPECT_TRUE(two.interval.low < 2 && two.value > 2 && two.interval.high > 4);
}

TEST(Censored, ASlopeIsInfiniteIfAllObservedValuesAreAtOneX) {
  const Values observed_left = values({1, 2, 3, 2, -4, -5, -4, -6});
  const auto slope = [](const Values& y, const std::vector<double>& x) {
    return censored_slope(y, x).value();
  };
  const Estimate up = slope(observed_left, {0, 0, 0, 0, 1, 1, 1, 1});
  EXPECT_EQ(up.value, infinite);
  EXPECT_EQ(up.interval.high, infinite);
  EXPECT_GT(up.interval.low, 0);
  EXPECT_FALSE(runs_to_resolve(up, 1, true));
  const Estimate down = slope(observed_left, {1, 1, 1, 1, 0, 0, 0, 0});
  EXPECT_EQ(down.value, -infinite);
  EXPECT_EQ(down.interval.low, -infinite);
  EXPECT_NEAR(down.interval.high, -up.interval.low, 1e-6);
  // Censored values at the same x change nothing; on both sides they bound the slope.
  EXPECT_EQ(slope(observed_left, {0, 0, 0, 0, 0, 1, 1, 1}).value, infinite);
  const Estimate both = slope(observed_left, {0, 0, 0, 0, 1, 1, -1, -1});
  EXPECT_TRUE(std::isfinite(both.value) && std::isfinite(both.interval.low) &&
              std::isfinite(both.interval.high));
  EXPECT_TRUE(std::isfinite(slope(observed_left, {0, 0, 0, 0.5, 1, 1, 1, 1}).value));
}

TEST(Censored, EqualValues) {
  expect_estimate(censored_mean(values({2, 2, 2, -2})), 2, 2, 2, 1e-5);
  expect_estimate(censored_mean(values({2, 2, 2, -1})), 2, 2, 2, 1e-5);
  const Estimate above = censored_mean(values({2, 2, 2, -3})).value();
  EXPECT_TRUE(above.value > 2 && above.interval.low < 2.01 && above.interval.high > 3);
  expect_estimate(censored_difference(values({2, 2, 2, -2}), values({1, 1, 1, 1}), true), 1, 1, 1,
                  1e-5);
  expect_estimate(censored_slope(values({1, 2, 3, -4}), std::vector<double>{0, 1, 2, 3}), 1, 1, 1,
                  1e-5);
}

// Coverage.

#ifdef NDEBUG
constexpr std::uint32_t coverage_draws = 2000;
#else
constexpr std::uint32_t coverage_draws =
    100;  // without optimization an interval takes forty times as long
#endif
constexpr std::uint32_t power_draws = coverage_draws / 2;

/// A value and the end of its run, if there is one.
struct Drawn {
  double value = 0;
  double end = infinite;
  CensoredValue seen() const { return {std::min(value, end), value > end}; }
};

/// Runs of which the share `censored` ends before the value is reached.
struct Source {
  std::string name;
  double true_mean = 0;
  double spread = 0;
  double at_least = 0;  ///< coverage
  /// `packing` and `own`: normal deviates. Two runs of one packing share the first one.
  std::function<Drawn(double packing, double own, double uniform, double censored)> draw;
};

/// The value has 17 % of its variance from the packing. Ends scatter with a fifth of the spread.
Source normal_source() {
  return {"normal", 0, 1, 0.88, [](double packing, double own, double uniform, double censored) {
            Drawn one{std::sqrt(0.17) * packing + std::sqrt(0.83) * own};
            if (censored > 0)
              one.end =
                  std::sqrt(1.04) * normal_quantile(1 - censored) + 0.2 * normal_quantile(uniform);
            return one;
          }};
}

/// phi at the onset of cells of N = 7900 at A = 0.05 rad, as measured in
/// experiments/results/nucleation: phi(n) = 0.6490 - 0.0104 n^-0.28, which packings displace by
/// 0.0004; one onset in 137 cycles at phi = 0.646, e times as many for each 0.003 in phi. Runs end
/// after a number of cycles.
Source hazard_source() {
  constexpr std::size_t cycles = 20000;
  constexpr double e_fold = 0.003, displaced = 0.0004;
  std::vector<double> phi, integral;  // of the hazard, for a packing that is not displaced
  for (std::size_t n = 1; n <= cycles; ++n) {
    phi.push_back(0.6490 - 0.0104 * std::pow(n, -0.28));
    integral.push_back((integral.empty() ? 0 : integral.back()) +
                       std::exp((phi.back() - 0.646) / e_fold) / 137);
  }
  const auto phi_at = [phi, integral](double reached) {
    const auto next = std::ranges::upper_bound(integral, reached);
    const auto k = std::min(static_cast<std::size_t>(next - integral.begin()), cycles - 1);
    const double from = k == 0 ? 0 : integral[k - 1];
    const double share = std::min(1.0, (reached - from) / (integral[k] - from));
    return phi[k] + (k + 1 < cycles ? share * (phi[k + 1] - phi[k]) : 0);
  };
  Source source{"measured hazard", 0, 0, 0.85,
                [=](double packing, double, double uniform, double censored) {
                  const double off = displaced * packing, faster = std::exp(off / e_fold);
                  Drawn one{phi_at(-std::log1p(-uniform) / faster) + off};
                  if (censored > 0) one.end = phi_at(-std::log(censored)) + off;
                  return one;
                }};
  constexpr int steps = 400;  // midpoints of equal probability
  double sum = 0, squares = 0, cubes = 0;
  for (int j = 0; j < steps; ++j) {
    for (int k = 0; k < steps; ++k) {
      const double value =
          source.draw(normal_quantile((j + 0.5) / steps), 0, (k + 0.5) / steps, 0).value - 0.646;
      sum += value;
      squares += value * value;
      cubes += value * value * value;
    }
  }
  constexpr double all = steps * steps;
  const double mean = sum / all, variance = squares / all - mean * mean;
  source.true_mean = 0.646 + mean;
  source.spread = std::sqrt(variance);
  fmt::print(
      "measured hazard: phi at the onset {:.5f}, standard deviation {:.5f}, skewness {:.2f}\n",
      source.true_mean, source.spread,
      (cubes / all - 3 * mean * variance - mean * mean * mean) / (variance * source.spread));
  return source;
}

struct Sample {
  std::vector<Drawn> a, b;  ///< a[k] and b[k] share a packing
  std::vector<Drawn> c;     ///< independent of both
};

Sample sampled(const Source& source, std::uint32_t id, std::size_t runs, double censored) {
  Sample sample;
  const std::vector<double> deviates = normal_numbers(id, 5 * runs);
  for (std::size_t k = 0; k < runs; ++k) {
    const auto counter = static_cast<std::uint32_t>(k);
    const auto [u, v] = uniform_pair({id, counter, 1, 1}, 7);
    const double w = uniform_pair({id, counter, 2, 1}, 7)[0];
    const double* z = &deviates[5 * k];
    sample.a.push_back(source.draw(z[0], z[1], u, censored));
    sample.b.push_back(source.draw(z[0], z[2], v, censored));
    sample.c.push_back(source.draw(z[3], z[4], w, censored));
  }
  return sample;
}

Values seen(std::vector<Drawn> drawn, double shift) {
  Values all;
  for (Drawn& one : drawn) {
    one.value += shift;
    all.push_back(one.seen());
  }
  return all;
}

struct Kind {
  const char* name;
  std::function<bool(const Source&, const Sample&)> holds;  ///< the true value
};

bool within(const std::optional<Estimate>& found, double truth) {
  return !found || (found->interval.low <= truth && truth <= found->interval.high);
}

/// Differences are those of half a spread: with none, errors of both groups would cancel.
const std::array kinds = {
    Kind{"mean", [](const Source& s,
                    const Sample& x) { return within(censored_mean(seen(x.a, 0)), s.true_mean); }},
    Kind{"difference, independent",
         [](const Source& s, const Sample& x) {
           const double half = 0.25 * s.spread;
           return within(censored_difference(seen(x.a, half), seen(x.c, -half), false), 2 * half);
         }},
    Kind{"difference, pairs",
         [](const Source& s, const Sample& x) {
           const double half = 0.25 * s.spread;
           return within(censored_difference(seen(x.a, half), seen(x.b, -half), true), 2 * half);
         }},
    Kind{"slope", [](const Source& s, const Sample& x) {
           std::vector<double> at;
           Values all;
           for (std::size_t k = 0; k < x.a.size(); ++k) {
             at.push_back(static_cast<double>(k % 4));
             all.push_back(seen({x.a[k]}, 0.5 * s.spread * (1.5 - at.back())).front());
           }
           return within(censored_slope(all, at), -0.5 * s.spread);
         }}};

TEST(CensoredCoverage, OfNormalRunsAndOfRunsWithTheMeasuredHazard) {
  constexpr std::array shares = {0.0, 0.12, 0.25, 0.35};
  const std::array sources = {normal_source(), hazard_source()};
  fmt::print("| runs | estimate | n |");
  for (const double share : shares) fmt::print(" {:.0f} % censored |", 100 * share);
  fmt::print("\n|---|---|---|{}\n", "---|---|---|---|");
  for (const Source& source : sources) {
    for (const Kind& kind : kinds) {
      for (const std::size_t runs : {6U, 8U, 12U, 20U}) {
        fmt::print("| {} | {} | {} |", source.name, kind.name, runs);
        for (const double share : shares) {
          std::uint32_t held = 0;
          for (std::uint32_t s = 0; s < coverage_draws; ++s)
            held += kind.holds(source, sampled(source, s, runs, share)) ? 1 : 0;
          const double covered = static_cast<double>(held) / coverage_draws;
          fmt::print(" {:.3f} |", covered);
          // Of few draws: 3 standard deviations of the simulation.
          const double slack =
              coverage_draws < 1000 ? 3 * std::sqrt(0.9 * 0.1 / coverage_draws) : 0;
          EXPECT_GE(covered, source.at_least - slack)
              << source.name << ", " << kind.name << ", " << runs << ", " << share;
        }
        fmt::print("\n");
      }
    }
  }
}

/// A claim on the onset that experiments/results/PLAN.md lists. `truth`: what the first look found;
/// `spread`: standard deviation of the onset of a run, by censored likelihood.
struct PlannedOnset {
  const char* id;
  double truth = 0;
  double spread = 0;
  double censored = 0;
  std::size_t groups = 1;
  std::vector<std::size_t> looks;
};

/// Share of campaigns in which the claim of 0 within 0.001 agrees at each look or before it.
std::vector<double> agreement(const PlannedOnset& claim, const Source& source) {
  const double level = look_level(claim.looks);
  std::vector<std::uint32_t> agreed(claim.looks.size());
  for (std::uint32_t s = 0; s < power_draws; ++s) {
    const Sample sample = sampled(source, s, claim.looks.back(), claim.censored);
    const auto runs_of = [&](const std::vector<Drawn>& drawn, double mean, std::size_t runs) {
      Values all = seen({drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(runs)}, 0);
      for (CensoredValue& one : all) {
        one.value = mean + claim.spread * (one.value - source.true_mean) / source.spread;
      }
      return all;
    };
    for (std::size_t k = 0; k < claim.looks.size(); ++k) {
      const Values a = runs_of(sample.a, claim.truth, claim.looks[k]);
      const auto found =
          claim.groups == 1
              ? censored_mean(a, level)
              : censored_difference(a, runs_of(sample.c, 0, claim.looks[k]), false, level);
      const Ruling ruling =
          found ? ruling_of(found->interval, 0.001, Relation::same) : Ruling::undecided;
      if (ruling == Ruling::undecided) continue;
      for (std::size_t later = k; ruling == Ruling::agrees && later < agreed.size(); ++later) {
        ++agreed[later];
      }
      break;  // the first verdict is final
    }
  }
  std::vector<double> shares;
  for (const std::uint32_t count : agreed) shares.push_back(1.0 * count / power_draws);
  return shares;
}

TEST(SecondLook, OnsetsAreDecidedInFourOfFiveCampaigns) {
  const std::vector<PlannedOnset> planned = {
      {"S5a.onset, A = 0.05", 0.0006, 0.0012, 0.03, 1, {36, 72}},
      {"S5a.onset, A = 0.04", -0.0004, 0.0012, 0.33, 1, {24, 54}},
      {"S6.onset, A = 0.04", 0, 0.0012, 0.33, 2, {30, 54}}};
  fmt::print("| claim | looks | level of a look | runs | agrees at each look |\n");
  fmt::print("|---|---|---|---|---|\n");
  for (const PlannedOnset& claim : planned) {
    for (const Source& source : {normal_source(), hazard_source()}) {
      const std::vector<double> shares = agreement(claim, source);
      fmt::print("| {} | {} | {:.4f} | {} | {:.2f} |\n", claim.id, fmt::join(claim.looks, ", "),
                 look_level(claim.looks), source.name, fmt::join(shares, ", "));
      EXPECT_GE(shares.back(), 0.8 - 3 * std::sqrt(0.8 * 0.2 / power_draws)) << claim.id;
    }
  }
}

}  // namespace
}  // namespace shearcell::test
