// SPDX-License-Identifier: GPL-3.0-or-later
// Rates of nucleation of runs whose rate is known.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "analysis/nucleation_rate.hpp"
#include "core/random.hpp"
#include "tests/analysis/made_up_runs.hpp"

namespace shearcell {
namespace {

using testing::made_up_run;

/// Of `grains` interior grains, at one phi, with an onset just before cycle `onset` (0: none).
FigureRun waiting(int grains, std::uint64_t seed, int onset, int cycles, double phi = 0.6451) {
  FigureRun run = made_up_run("grains", grains, seed, cycles, [=](int n, Measures& m) {
    m.phi = phi;
    m.interior_grains = static_cast<std::size_t>(grains);
    m.largest_crystallite = onset > 0 && n >= onset ? 16 : 0;  // critical at A = 0.0833
  });
  run.parameters["grains"] = grains;
  return run;
}

std::vector<const FigureRun*> all(const std::vector<FigureRun>& runs) {
  std::vector<const FigureRun*> pointers;
  for (const FigureRun& run : runs) pointers.push_back(&run);
  return pointers;
}

TEST(NucleationRate, IsEventsOverGrainCycles) {
  const std::vector<FigureRun> runs = {waiting(1000, 1, 10, 30), waiting(1000, 2, 20, 30),
                                       waiting(1000, 3, 0, 30), waiting(1000, 4, 0, 30, 0.6401)};
  const auto rates = nucleation_rates(all(runs));
  ASSERT_EQ(rates.size(), 2U);
  EXPECT_DOUBLE_EQ(rates[0].phi_low, 0.64);
  EXPECT_EQ(rates[0].events, 0U);
  EXPECT_DOUBLE_EQ(rates[0].grain_cycles, 30e3);
  EXPECT_EQ(rates[0].interval.low, 0);
  EXPECT_NEAR(rates[0].interval.high, 2.9957 / 30e3, 1e-8) << "-ln 0.05: the rule of three";
  EXPECT_DOUBLE_EQ(rates[1].phi_low, 0.644);
  EXPECT_EQ(rates[1].events, 2U);
  EXPECT_DOUBLE_EQ(rates[1].grain_cycles, 60e3);
  EXPECT_DOUBLE_EQ(rates[1].rate, 2 / 60e3);
  EXPECT_NEAR(rates[1].interval.low, 0.35536 / 60e3, 1e-9) << "Garwood, 90 %, two events";
  EXPECT_NEAR(rates[1].interval.high, 6.29579 / 60e3, 1e-9);
}

TEST(NucleationRate, LeavesOutRunsThatBeginWithACriticalCrystallite) {
  std::vector<FigureRun> runs = {waiting(1000, 1, 10, 30)};
  for (CheckpointMeasures& c : runs[0].checkpoints) c.measures.largest_crystallite = 16;
  EXPECT_TRUE(nucleation_rates(all(runs)).empty());
}

// With one stratum and two sizes the maximum is where each size has its own rate.
TEST(SizeExponent, OfTwoSizesIsTheSlopeBetweenTheirRates) {
  std::vector<FigureRun> runs;
  double cycles[2] = {}, events[2] = {};
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const int size : {0, 1}) {
      const int grains = size == 0 ? 500 : 3000;
      const int onset = static_cast<int>(1 + seed * (size == 0 ? 7 : 2) % 50);
      const bool seen = onset <= 35;
      runs.push_back(waiting(grains, seed, seen ? onset : 0, 35));
      cycles[size] += seen ? onset : 35;
      events[size] += seen ? 1 : 0;
    }
  }
  const auto found = size_exponent(all(runs));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value,
              std::log(events[1] / cycles[1] / (events[0] / cycles[0])) / std::log(6.0), 1e-6);
  EXPECT_LT(found->interval.low, found->value);
  EXPECT_GT(found->interval.high, found->value);
}

// phi rises to 0.648 over 40 cycles and the rate with it; the interval holds the true exponent.
TEST(SizeExponent, IsThatOfRunsMadeWithIt) {
  for (const double exponent : {1.0, 2.0 / 3}) {
    std::vector<FigureRun> runs;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      for (const int grains : {500, 1500, 4500}) {
        const double chance = uniform_pair(
            {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(grains), 0, 0}, 7)[0];
        double hazard = 0;
        int onset = 0;
        const auto phi = [](int n) { return 0.6401 + 0.0002 * n; };
        for (int n = 0; n < 60 && onset == 0; ++n) {
          hazard += 2e-5 * std::exp((phi(n) - 0.644) / 0.002) * std::pow(grains, exponent);
          if (hazard > -std::log(chance)) onset = n + 1;
        }
        runs.push_back(waiting(grains, seed, onset, 60));
        for (CheckpointMeasures& c : runs.back().checkpoints) {
          c.measures.phi = phi(static_cast<int>(c.cycle));
        }
      }
    }
    const auto found = size_exponent(all(runs));
    ASSERT_TRUE(found);
    EXPECT_LT(found->interval.low, exponent);
    EXPECT_GT(found->interval.high, exponent);
    EXPECT_LT(found->interval.high - found->interval.low, 0.4);
  }
}

TEST(SizeExponent, NeedsTwoSizesAtOnePhi) {
  const std::vector<FigureRun> one = {waiting(1000, 1, 5, 30), waiting(1000, 2, 6, 30),
                                      waiting(1000, 3, 7, 30)};
  EXPECT_FALSE(size_exponent(all(one)));
  const std::vector<FigureRun> apart = {waiting(1000, 1, 5, 30), waiting(1000, 2, 6, 30),
                                        waiting(3000, 3, 7, 30, 0.6501)};
  EXPECT_FALSE(size_exponent(all(apart)));
}

TEST(FigureNucleation, DrawsEachSizeAndDecidesByTheExponent) {
  std::vector<FigureRun> runs;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    runs.push_back(waiting(1000, seed, static_cast<int>(1 + seed * 7 % 60), 60));
    runs.push_back(waiting(3000, seed, static_cast<int>(1 + seed * 7 % 60) / 3 + 1, 60));
  }
  const FigureResult result = find_figure("nucleation")->make(runs);
  ASSERT_EQ(result.tables.size(), 2U);
  EXPECT_EQ(result.tables[1].rows.size(), 2U);
  EXPECT_NE(to_csv(result.tables[0]).find("A=0.0833 N=1000,"), std::string::npos);
  ASSERT_EQ(result.verdicts.size(), 1U);
  ASSERT_TRUE(result.verdicts[0].estimate);
  EXPECT_NEAR(*result.verdicts[0].estimate, 0, 0.15);
  EXPECT_TRUE(find_figure("nucleation")->make(std::span(runs.data(), 1)).verdicts.empty());
}

}  // namespace
}  // namespace shearcell
