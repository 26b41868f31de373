// SPDX-License-Identifier: GPL-3.0-or-later
// Table I at N = 2000, the whole way: a settled packing has the numbers of model.md, and ten cycles
// at A = 0.0833 compact it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "analysis/measures.hpp"
#include "core/diagnostics.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

TEST(PackingOf2000, SettlesAndCompactsAsTheModelSays) {
  const TemporaryFolder folder;
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
  EXPECT_LT(at_rest.mean_overlap, 4.5e-3);

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

// The virial gives the pressure within the packing from its overlaps,
//     P = sum over contacts of k delta (d - delta) / (3 V),
// so Table I's P and k leave no choice of the mean overlap: it must be near 3 P V / (n_c k d). The
// sum runs over interior grains, each with half of its contacts, and V over their Voronoi cells.
TEST(PackingOf2000, HasTheOverlapThatThePressureDemands) {
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  ASSERT_EQ(test::compute(store,
                          "experiment: packing\n"
                          "base: {grains: 2000, gravity_m_per_s2: 0, cycles: 0}\n")
                .completed,
            2U);
  const RunRecord packing = test::runs_of_kind(store, "prepare").at(0);
  const Checkpoint settled = store.load_checkpoint(store.checkpoints(packing.id).back());
  const Analysis found = analyse(settled);
  const Eigen::Matrix3Xd& grains = settled.state.position;
  Eigen::Vector3d virial = Eigen::Vector3d::Zero();
  double volume = 0, overlaps = 0, halves = 0;
  const auto interior = [&](std::int32_t i) {
    return found.grains.interior[static_cast<std::size_t>(i)];
  };
  for (std::size_t i = 0; i < found.grains.interior.size(); ++i) {
    if (found.grains.interior[i] != 0) volume += found.grains.cell_volume[i];
  }
  const WallPose pose = wall_pose(settled.cell, 0, settled.state.wall_height);
  for_each_contact(settled.cell, grains, pose, [&](const Contact& contact) {
    if (contact.kind != Contact::Kind::grain) return;
    const double ends = interior(contact.grain) + interior(contact.other);
    virial += ends / 2 * contact.overlap * (1 - contact.overlap) * contact.normal.cwiseAbs2();
    overlaps += ends / 2 * contact.overlap;
    halves += ends / 2;
  });
  const Parameters table_1;
  const double stiffness = table_1.stiffness_N_per_m / table_1.diameter_m;  // k/d [Pa]
  const Eigen::Vector3d stress = stiffness * virial / volume;
  const double contacts = 2 * halves / static_cast<double>(found.measures.interior_grains);
  std::printf(
      "without gravity: stress from the overlaps x %.1f, y %.1f, z %.1f Pa (applied: %.0f), mean "
      "overlap of interior grains %.3e d, %.3f contacts per grain\n",
      stress.x(), stress.y(), stress.z(), table_1.pressure_Pa, overlaps / halves, contacts);
  // The rough side walls bear the rest.
  EXPECT_LT(stress.y(), table_1.pressure_Pa);
  EXPECT_GT(stress.y(), 0.85 * table_1.pressure_Pa);
  // S B.4 states less than 1e-3.
  EXPECT_GT(overlaps / halves, 2e-3);
}

}  // namespace
}  // namespace shearcell
