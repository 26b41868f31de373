// SPDX-License-Identifier: GPL-3.0-or-later
// Levels of planned looks compared with published constants and with scipy's quadrature, false
// verdicts by simulation, and power compared with scipy's integral over the sample variance.
#include "analysis/looks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::test {
namespace {

using Looks = std::vector<std::size_t>;

Looks equally_spaced(std::size_t count) {
  Looks looks;
  for (std::size_t k = 1; k <= count; ++k) looks.push_back(10 * k);
  return looks;
}

TEST(LookLevel, IsThatOfPocock) {
  // Two-sided nominal levels for 0.05: S. J. Pocock, Biometrika 64, 191 (1977), table 1.
  EXPECT_NEAR(1 - look_level(equally_spaced(2), 0.95), 0.0294, 5e-5);
  EXPECT_NEAR(1 - look_level(equally_spaced(3), 0.95), 0.0221, 5e-5);
  EXPECT_NEAR(1 - look_level(equally_spaced(5), 0.95), 0.0158, 5e-5);
  EXPECT_NEAR(1 - look_level(equally_spaced(10), 0.95), 0.0106, 5e-5);
  // Quantiles for 0.1: C. Jennison and B. W. Turnbull, Group Sequential Methods (2000), table 2.1.
  const auto quantile = [](std::size_t count) {
    return normal_quantile((1 + look_level(equally_spaced(count))) / 2);
  };
  EXPECT_NEAR(quantile(2), 1.875, 5e-4);
  EXPECT_NEAR(quantile(3), 1.992, 5e-4);
  EXPECT_NEAR(quantile(4), 2.067, 5e-4);
  EXPECT_NEAR(quantile(5), 2.122, 5e-4);
}

TEST(LookLevel, OfUnequalLooksIsThatOfScipysQuadrature) {
  EXPECT_NEAR(look_level(Looks{12, 36, 60}), 0.9571601557, 1e-7);
  EXPECT_NEAR(look_level(Looks{12, 36, 60}, 0.95), 0.9795256643, 1e-7);
  EXPECT_NEAR(look_level(Looks{6, 12, 20}), 0.9548339854, 1e-7);
  EXPECT_NEAR(look_level(Looks{59, 60}), 0.9097897223, 1e-6) << "nearly the same runs";
  EXPECT_NEAR(look_level(Looks{1, 100000}), std::sqrt(0.9), 1e-3) << "independent";
}

TEST(LookLevel, OfOneLookIsTheLevel) {
  EXPECT_EQ(look_level(Looks{12}), confidence_level);
  EXPECT_EQ(look_level({}), confidence_level);
  EXPECT_EQ(look_level(Looks{12}, 0.95), 0.95);
}

#ifdef NDEBUG
constexpr std::uint32_t kCampaigns = 20000;
#else
constexpr std::uint32_t kCampaigns = 1000;
#endif

/// Percentages of campaigns of normal runs in which the interval of some look is above or below the
/// true value.
std::array<double, 2> false_verdicts(const Looks& looks, double level, std::uint32_t campaigns) {
  std::array<std::uint32_t, 2> above_below = {};
  for (std::uint32_t s = 0; s < campaigns; ++s) {
    const std::vector<double> values = normal_numbers(s, looks.back());
    bool above = false, below = false;
    for (const std::size_t runs : looks) {
      const Interval interval = mean_of(std::span(values).first(runs), level)->interval;
      above = above || interval.low > 0;
      below = below || interval.high < 0;
    }
    above_below[0] += above ? 1 : 0;
    above_below[1] += below ? 1 : 0;
  }
  return {100.0 * above_below[0] / campaigns, 100.0 * above_below[1] / campaigns};
}

TEST(LookLevel, FalseVerdictsAreOneInTwentyOnEachSide) {
  fmt::print(
      "| looks | level of each look | false verdicts above | below | with 90 % at each look |\n"
      "|---|---|---|---|---|\n");
  Looks many;
  for (std::size_t runs = 10; runs <= 40; runs += 2) many.push_back(runs);
  for (const Looks& looks : {Looks{6, 12, 20}, Looks{6, 30}, Looks{12, 36, 60}, many}) {
    const double level = look_level(looks);
    const auto [above, below] = false_verdicts(looks, level, kCampaigns);
    const auto naive = false_verdicts(looks, confidence_level, kCampaigns / 10 + 900);
    fmt::print("| {} to {}, {} | {:.4f} | {:.2f} % | {:.2f} % | {:.2f} %, {:.2f} % |\n",
               looks.front(), looks.back(), looks.size(), level, above, below, naive[0], naive[1]);
    // Both sides are alike, so that together they are known better. Of few kCampaigns: 3 standard
    // deviations.
    const double slack = kCampaigns < 5000 ? 300 * std::sqrt(0.05 * 0.95 / (2.0 * kCampaigns)) : 0;
    EXPECT_LE((above + below) / 2, 5.5 + slack);
    EXPECT_GE((naive[0] + naive[1]) / 2, 7);
  }
}

TEST(PowerOf, OneLookIsThatOfTheIntegralOverTheSampleVariance) {
  const auto expect = [](double margin, double truth, std::size_t groups, std::size_t runs,
                         double agrees, double differs) {
    const std::vector<LookPower> found = power_of({"", margin}, truth, 1, groups, Looks{runs});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].runs, runs);
    EXPECT_NEAR(found[0].as_claimed, agrees, 0.025);  // 3 standard deviations of 4000 kCampaigns
    EXPECT_NEAR(found[0].against, differs, 0.025);
  };
  expect(1, 0, 1, 12, 0.8894, 0.0000);
  expect(0.5, 1, 1, 12, 0.0004, 0.4919);
  expect(1, 0, 2, 20, 0.9940, 0.0000);
  expect(0.8, 0.3, 2, 8, 0.2926, 0.0014);
}

TEST(PowerOf, LaterLooksDecideMoreAndTheFirstVerdictIsFinal) {
  const Looks looks = {6, 12, 24};
  const std::vector<LookPower> found = power_of({"", 1}, 0, 1, 1, looks);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_LT(found[0].as_claimed, found[1].as_claimed);
  EXPECT_LT(found[1].as_claimed, found[2].as_claimed);
  EXPECT_GT(found[2].as_claimed, 0.99);
  // At the edge of the margin the claim agrees in one case of twenty, at all looks together.
  const std::vector<LookPower> edge = power_of({"", 1}, 1, 1, 1, looks);
  EXPECT_LE(edge[2].as_claimed, 0.06);
  EXPECT_GT(edge[2].as_claimed, 0.03);
  const std::vector<LookPower> higher = power_of({"", 1, Relation::higher}, 2, 1, 1, looks);
  EXPECT_GT(higher[2].as_claimed, 0.99);
  EXPECT_EQ(power_of({"", 1}, 0, 1, 1, looks)[1].as_claimed, found[1].as_claimed);
  EXPECT_EQ(power_of({"", 1e-3}, 0, 1e-3, 1, looks)[1].as_claimed, found[1].as_claimed) << "units";
}

/// A claim that experiments/results/PLAN.md lists. `truth` and `spread`: what the first look found.
struct Planned {
  const char* id;
  Claim claim;
  double truth = 0;
  double spread = 0;
  std::size_t groups = 1;
  Looks looks;
  bool primary = true;
};

TEST(SecondLook, PrimaryClaimsAreDecidedInFourOfFiveCampaigns) {
  const Claim phi = {"", 0.001}, percentage = {"", 2}, phi_at_rest = {"", 2e-4, Relation::higher};
  const std::vector<Planned> planned = {
      {"S2.percentage", percentage, 0.16, 3.69, 1, {20, 40}},
      {"S2.phi", phi, 0.00005, 0.00062, 1, {20, 40}},
      {"S4.phi", phi, 0.00039, 0.00097, 2, {12, 24}},
      {"B5.onset", phi, -0.00019, 0.00142, 1, {20, 40}},
      {"B5.offset", {"", 2e-4, Relation::higher}, 0.00063, 0.00040, 1, {20, 40}},
      {"B5.growth", {"", 5e-5, Relation::higher}, -0.4e-5, 1.0e-4, 1, {20, 40}},
      {"choices.phi, wall mass x3", phi, 0.00046, 0.00111, 2, {20, 40}},
      {"S3.percentage, 2.6e-5 s", percentage, 1.63, 2.16, 1, {40, 100, 200}, false},
      {"S3.percentage, 3.5e-5 s", percentage, 2.16, 2.75, 1, {40, 100, 200}, false},
      {"S3.phi, 3.5e-5 s", phi, 0.00093, 0.00278, 1, {40, 100, 200}, false},
      {"S3.onset, 1.0e-4 s", phi, -0.00064, 0.0016, 1, {60, 130}, false},
      {"S4.percentage", percentage, 1.63, 2.93, 2, {40, 100, 200}, false},
      {"B5.rest", phi_at_rest, 0.00018, 0.00039, 1, {40, 100, 200}, false},
      {"S5a.methods, A = 0.05", phi, 0.00051, 0.00235, 1, {60, 120}, false},
      {"S5a.methods, A = 0.04", phi, 0.00079, 0.00373, 1, {60, 120}, false},
      {"S5b.slope", {"", 7e-4}, -0.00128, 0.00242, 1, {38, 100}, false}};
  fmt::print("| claim | looks | level of a look | as claimed, against at each look |\n");
  fmt::print("|---|---|---|---|\n");
  for (const Planned& one : planned) {
    fmt::print("| {} | {} | {:.4f} |", one.id, fmt::join(one.looks, ", "), look_level(one.looks));
    const auto powers = power_of(one.claim, one.truth, one.spread, one.groups, one.looks);
    for (const LookPower& look : powers) {
      fmt::print(" {:.2f}, {:.2f};", look.as_claimed, look.against);
    }
    fmt::print(" |\n");
    const double decided = std::max(powers.back().as_claimed, powers.back().against);
    EXPECT_EQ(decided >= 0.8, one.primary) << one.id << ": " << decided;
  }
}

}  // namespace
}  // namespace shearcell::test
