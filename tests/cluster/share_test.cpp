// SPDX-License-Identifier: GPL-3.0-or-later
// Sharing out: every run once, packings settled once, the same every time, nobody much busier.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "experiments/cluster/share.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

std::vector<Plan> plans(const std::string& text, const ExpandOptions& options = {}) {
  return {expand(parse_manifest(text, "tiny.yaml"), options)};
}

ExpandOptions of(std::uint64_t seeds, std::uint64_t cycles = 2) {
  ExpandOptions options;
  options.seeds = seeds;
  options.cycles = cycles;
  return options;
}

TEST(WorkLeft, BundlesRunsByTheirPacking) {
  const auto bundles = work_left(plans(tiny_manifest("", kBothFluids), of(3)), {});
  ASSERT_EQ(bundles.size(), 3U);
  for (const Bundle& bundle : bundles) {
    EXPECT_EQ(bundle.runs.size(), 2U) << "both fluids shear one packing";
    EXPECT_GT(bundle.particle_steps, 2 * 2 * kStepsPerCycle * kGrains)
        << "and it must settle first";
  }
}

TEST(WorkLeft, TakesARunOfTwoManifestsOnceAndAtItsLongerLength) {
  const std::string both = tiny_manifest("", kBothFluids);
  std::vector<Plan> two = plans(both, of(2));
  const auto shorter = work_left(two, {});
  two.push_back(plans(tiny_manifest(), of(2, 9)).front());  // the still fluid, longer
  const auto bundles = work_left(two, {});
  ASSERT_EQ(bundles.size(), 2U);
  EXPECT_EQ(bundles[0].runs, shorter[0].runs);
  EXPECT_NEAR(bundles[0].particle_steps - shorter[0].particle_steps, 7.0 * kStepsPerCycle * kGrains,
              1);
}

TEST(WorkLeft, LeavesOutWhatTheStoreHolds) {
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store, text, of(1));
  EXPECT_TRUE(work_left(plans(text, of(1)), store.runs()).empty());
  const auto more = work_left(plans(text, of(2)), store.runs());
  ASSERT_EQ(more.size(), 1U);
  EXPECT_EQ(more[0].runs.size(), 2U);
  // A longer run continues: its packing and its first cycles cost nothing.
  const auto longer = work_left(plans(text, of(1, 5)), store.runs());
  ASSERT_EQ(longer.size(), 1U);
  EXPECT_NEAR(longer[0].particle_steps, 2 * 3.0 * kStepsPerCycle * kGrains, 1);
}

Bundle bundle(const std::string& name, double cost) {
  return {name, {name + "a", name + "b"}, cost};
}

TEST(SharingOut, GivesEveryRunToOneTaskWithItsPacking) {
  std::vector<Bundle> bundles;
  for (int b = 0; b < 23; ++b) bundles.push_back(bundle(fmt::format("p{}", b), 1 + b % 5));
  for (const std::size_t tasks : {1U, 2U, 7U, 22U, 23U, 500U}) {
    const auto shares = share_out(bundles, tasks);
    EXPECT_EQ(shares.size(), std::min<std::size_t>(tasks, 23));
    std::map<std::string, int> times;
    double least = 1e9, most = 0;
    for (const Share& share : shares) {
      EXPECT_FALSE(share.runs.empty());
      EXPECT_EQ(share.runs.size(), 2 * share.packings);
      EXPECT_EQ(share.stages.size(), 3 * share.packings);
      for (const std::string& run : share.runs) {
        ++times[run];
        EXPECT_TRUE(share.stages.contains(run.substr(0, run.size() - 1))) << "its packing";
      }
      least = std::min(least, share.particle_steps);
      most = std::max(most, share.particle_steps);
    }
    EXPECT_EQ(times.size(), 46U);
    for (const auto& [run, count] : times) EXPECT_EQ(count, 1) << run;
    EXPECT_LE(most - least, 5) << "tasks differ by no more than the largest bundle";
  }
}

TEST(SharingOut, GoesRoundWhenAllCostTheSame) {
  const std::vector<Bundle> bundles = {bundle("p", 3), bundle("q", 3), bundle("r", 3),
                                       bundle("s", 3)};
  const auto shares = share_out(bundles, 2);
  EXPECT_EQ(shares[0].runs, (std::vector<std::string>{"pa", "pb", "ra", "rb"}));
  EXPECT_EQ(shares[1].runs, (std::vector<std::string>{"qa", "qb", "sa", "sb"}));
}

TEST(SharingOut, LeavesNoTaskEmptyWhenNothingCostsAnything) {
  const auto shares = share_out({bundle("p", 0), bundle("q", 0), bundle("r", 0)}, 3);
  for (const Share& share : shares) EXPECT_EQ(share.packings, 1U);
}

TEST(SharingOut, OfNothingIsNothing) {
  EXPECT_TRUE(share_out({}, 5).empty());
}

}  // namespace
}  // namespace shearcell
