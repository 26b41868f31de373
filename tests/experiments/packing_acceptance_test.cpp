// SPDX-License-Identifier: GPL-3.0-or-later
// Table I at N = 2000: a settled packing has the expected numbers, and ten cycles at A = 0.0833
// compact it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "analysis/measures.hpp"
#include "core/filling.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell::test {
namespace {

using PackingOf2000 = StoreTest;

// The walls bear the weight and nothing else, and the moving wall its load.
void expect_balance(const Analysis& analysis) {
  const Parameters p;
  const RunFacts run{.parameters = {{"stiffness_N_per_m", p.stiffness_N_per_m},
                                    {"mass_kg", p.mass_kg},
                                    {"diameter_m", p.diameter_m},
                                    {"gravity_m_per_s2", p.gravity_m_per_s2}}};
  const nlohmann::json measured =
      provider("mechanics").compute({.analysis = &analysis, .run = &run});
  const auto in_si = [&](const char* name) { return measured.at(name).get<double>(); };
  const double weight =
      static_cast<double>(analysis.measures.grains) * p.mass_kg * p.gravity_m_per_s2;
  const double x = in_si("force_bottom_x_N") + in_si("force_top_x_N") + in_si("force_left_x_N") +
                   in_si("force_right_x_N");
  const double y = in_si("force_bottom_y_N") + in_si("force_top_y_N") + in_si("force_left_y_N") +
                   in_si("force_right_y_N");
  std::printf("forces on the walls: x %.3g N, y %.5g N (weight %.5g N); pressure %.1f Pa\n", x, y,
              -weight, in_si("contact_pressure_Pa"));
  EXPECT_NEAR(y, -weight, 0.01 * weight);
  EXPECT_NEAR(x, 0, 0.01 * weight);
  Geometry shape;
  shape.grains = analysis.measures.grains;
  const double width = cell_width(shape) * p.diameter_m;
  const double load = p.pressure_Pa * width * width + weight;
  EXPECT_NEAR(-in_si("force_bottom_y_N"), load, 0.01 * load);
  // From what the top feels to what the bottom feels.
  EXPECT_GT(in_si("contact_pressure_Pa"), 0.9 * p.pressure_Pa);
  EXPECT_LT(in_si("contact_pressure_Pa"), 1.05 * load / (width * width));
}

TEST_F(PackingOf2000, SettlesAndCompactsAsExpected) {
  const CampaignResult result = compute(store_,
                                        "experiment: packing\n"
                                        "base: {grains: 2000, cycles: 10}\n");
  ASSERT_EQ(result.completed, 2U);
  const Stage packing = runs_of_kind(store_, "prepare").at(0);
  const CheckpointRecord settled = store_.checkpoints(packing.id).back();
  const Analysis packed = analyse(store_.load_checkpoint(settled));
  const PackingMeasures& at_rest = packed.measures;
  const double imbalance = settled.observables.at("wall_force_imbalance");
  std::printf(
      "settled in %.2f s: wall imbalance %.3g, phi %.4f (phi_u %.4f), N_inves %zu, "
      "%.3f contacts per grain, mean overlap %.3e d\n",
      settled.time_s, imbalance, at_rest.phi, at_rest.phi_uncorrected, at_rest.interior_grains,
      at_rest.contacts_per_grain, at_rest.mean_overlap_d);
  EXPECT_LT(std::fabs(imbalance), 0.01);
  EXPECT_GT(at_rest.phi, 0.60);
  EXPECT_LT(at_rest.phi, 0.645);
  EXPECT_GT(at_rest.contacts_per_grain, 5.5);
  EXPECT_LT(at_rest.contacts_per_grain, 6.6);
  EXPECT_GT(at_rest.mean_overlap_d, 1.5e-3);
  EXPECT_LT(at_rest.mean_overlap_d, 4.5e-3);
  expect_balance(packed);

  const Stage run = sheared(store_);
  const auto checkpoints = store_.checkpoints(run.id);
  ASSERT_EQ(checkpoints.size(), 11U);
  double late = 0;  // mean over the last three cycles
  for (const CheckpointRecord& record : checkpoints) {
    const PackingMeasures measures = analyse(store_.load_checkpoint(record)).measures;
    std::printf("cycle %2g: phi %.4f, crystalline %.2f %%\n", record.cycle, measures.phi,
                measures.crystalline_percent);
    if (record.cycle > 7) late += measures.phi / 3;
  }
  EXPECT_GT(late, 0.638);
  EXPECT_GT(late, at_rest.phi);
  EXPECT_EQ(analyse(store_.load_checkpoint(checkpoints.front())).measures.phi, at_rest.phi);
}

// The virial gives the pressure within the packing from its overlaps,
//     P = sum over contacts of k delta (d - delta) / (3 V),
// so Table I's P and k leave no choice of the mean overlap. With n interior grains a volume and z
// contacts a grain, P = n z <delta (d - delta)> k / 6.
TEST_F(PackingOf2000, HasTheOverlapOfThePressure) {
  ASSERT_EQ(compute(store_,
                    "experiment: packing\n"
                    "base: {grains: 2000, gravity_m_per_s2: 0, cycles: 0}\n")
                .completed,
            2U);
  const Stage packing = runs_of_kind(store_, "prepare").at(0);
  const Analysis found = analyse(store_.load_checkpoint(store_.checkpoints(packing.id).back()));
  const Mechanics& m = found.mechanics;
  const Parameters table_1;
  const double unit = table_1.stiffness_N_per_m / table_1.diameter_m;  // k/d [Pa]
  double volume = 0;
  for (std::size_t i = 0; i < found.grains.interior.size(); ++i) {
    if (found.grains.interior[i] != 0) volume += found.grains.cells.volume[i];
  }
  const double density = static_cast<double>(found.measures.interior_grains) / volume;
  const double overlap = 6 * m.pressure / (density * m.coordination);  // mean of delta (d - delta)
  std::printf(
      "without gravity: stress x %.1f, y %.1f, z %.1f Pa (applied: %.0f), %.3f contacts per grain, "
      "%.1f %% rattlers; mean overlap %.3e d, demanded by the stress %.3e d\n",
      unit * m.stress(0, 0), unit * m.stress(1, 1), unit * m.stress(2, 2), table_1.pressure_Pa,
      m.coordination, m.rattlers, found.measures.mean_overlap_d, overlap);
  // The rough side walls bear the rest.
  EXPECT_LT(unit * m.stress(1, 1), table_1.pressure_Pa);
  EXPECT_GT(unit * m.stress(1, 1), 0.85 * table_1.pressure_Pa);
  // Near the walls grains overlap a little less or more than in the interior.
  EXPECT_NEAR(found.measures.mean_overlap_d, overlap, 0.05 * overlap);
  // S B.4 states less than 1e-3.
  EXPECT_GT(found.measures.mean_overlap_d, 2e-3);
}

}  // namespace
}  // namespace shearcell::test
