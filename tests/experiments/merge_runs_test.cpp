// SPDX-License-Identifier: GPL-3.0-or-later
// Stores that computed parts of one campaign, merged, are the store that computed all of it.
#include <gtest/gtest.h>

#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

TEST(MergedCampaign, OfThreeMachinesIsWholeAndGoesOn) {
  const TemporaryFolder folder;
  const std::string text = tiny_manifest("", kBothFluids);
  const auto store_at = [&](const char* name) { return folder.path() / name; };
  ExpandOptions two_seeds;
  two_seeds.seeds = 2;
  {
    Store a(store_at("a"), Access::create), b(store_at("b"), Access::create),
        c(store_at("c"), Access::create), whole(store_at("whole"), Access::create);
    compute(a, text);                // one seed, both fluids
    compute(b, tiny_manifest());     // the same packing, one fluid: shared
    compute(c, text, two_seeds, 1);  // both seeds
    compute(whole, text);
    compute(whole, tiny_manifest());
    compute(whole, text, two_seeds);
  }
  Store merged(store_at("merged"), Access::create);
  const auto reports = merged.merge({store_at("a"), store_at("b"), store_at("c")});
  EXPECT_EQ(reports[1].checkpoints, 0U) << "the second one computed what the first had";
  const Store whole(store_at("whole"), Access::read);
  EXPECT_EQ(final_hashes(merged), final_hashes(whole));
  for (const RunRecord& run : whole.runs()) {
    const RunRecord other = merged.run(run.id);
    EXPECT_EQ(other.state, run.state);
    EXPECT_EQ(other.attempts, run.attempts);
    EXPECT_EQ(other.memberships.size(), run.memberships.size());
    EXPECT_EQ(other.particle_steps, run.particle_steps) << "an effort was counted twice";
    EXPECT_EQ(cycles_of(merged, run.id), cycles_of(whole, run.id));
  }
  EXPECT_TRUE(merged.verify().ok());
  // Nothing is computed again, and more can be added.
  EXPECT_EQ(compute(merged, text, two_seeds).completed, 0U);
  two_seeds.cycles = 3;
  EXPECT_EQ(compute(merged, text, two_seeds).completed, 4U);
}

}  // namespace
}  // namespace shearcell
