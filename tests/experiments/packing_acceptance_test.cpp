// SPDX-License-Identifier: GPL-3.0-or-later
// Table I at N = 2000, the whole way: a settled packing has the numbers of model.md, and ten cycles
// at A = 0.0833 compact it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "analysis/measures.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

TEST(PackingOf2000, SettlesAndCompactsAsTheModelSays) {
  const test::TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  const CampaignResult result = test::compute(store,
                                              "experiment: packing\n"
                                              "base: {grains: 2000, cycles: 10}\n");
  ASSERT_EQ(result.completed, 2U);
  const RunRecord packing = test::runs_of_kind(store, "prepare").at(0);
  const CheckpointRecord settled = store.checkpoints(packing.id).back();
  const Measures at_rest = measure(store.load_checkpoint(settled));
  const double imbalance = settled.observables.at("wall_force_imbalance");
  std::printf(
      "settled in %.2f s: wall imbalance %.3g, phi %.4f (phi_u %.4f), N_inves %zu, "
      "%.3f contacts per grain, mean overlap %.3e d\n",
      settled.time_s, imbalance, at_rest.phi, at_rest.phi_uncorrected, at_rest.interior_grains,
      at_rest.contacts_per_grain, at_rest.mean_overlap);
  EXPECT_LT(std::fabs(imbalance), 0.01);
  EXPECT_GT(at_rest.phi, 0.60);
  EXPECT_LT(at_rest.phi, 0.645);
  EXPECT_GT(at_rest.contacts_per_grain, 5.5);
  EXPECT_LT(at_rest.contacts_per_grain, 6.6);
  EXPECT_GT(at_rest.mean_overlap, 1.5e-3);
  EXPECT_LT(at_rest.mean_overlap, 3.5e-3);

  const RunRecord run = test::runs_of_kind(store, "shear").at(0);
  const auto checkpoints = store.checkpoints(run.id);
  ASSERT_EQ(checkpoints.size(), 11U);
  double late = 0;  // mean over the last three cycles
  for (const CheckpointRecord& record : checkpoints) {
    const Measures measures = measure(store.load_checkpoint(record));
    std::printf("cycle %2g: phi %.4f, crystalline %.2f %%\n", record.cycle, measures.phi,
                measures.crystalline_percent);
    if (record.cycle > 7) late += measures.phi / 3;
  }
  EXPECT_GT(late, 0.638);
  EXPECT_GT(late, at_rest.phi);
  EXPECT_EQ(measure(store.load_checkpoint(checkpoints.front())).phi, at_rest.phi);
}

}  // namespace
}  // namespace shearcell
