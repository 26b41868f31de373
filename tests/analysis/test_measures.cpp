// SPDX-License-Identifier: GPL-3.0-or-later
// All measures of one checkpoint together.
#include <gtest/gtest.h>

#include "analysis/measures.hpp"
#include "analysis/packing_fraction.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::testing {
namespace {

Checkpoint checkpoint_of(const Packing& p, double theta) {
  Checkpoint c;
  c.theta = theta;
  c.cell = p.cell;
  c.state.position = p.grains;
  c.state.velocity = Eigen::Matrix3Xd::Zero(3, p.grains.cols());
  c.state.wall_height = p.pose.bottom;
  return c;
}

TEST(Measures, PerfectCrystal) {
  const Packing p = lattice(Lattice::fcc, 6);
  const Analysis a = analyse(checkpoint_of(p, 0));
  EXPECT_EQ(a.measures.grains, static_cast<std::size_t>(p.grains.cols()));
  EXPECT_GT(a.measures.interior_grains, 100U);
  EXPECT_NEAR(a.measures.phi_uncorrected, 0.74048, 5e-6);
  EXPECT_NEAR(a.measures.phi, 0.74048, 5e-6);
  EXPECT_DOUBLE_EQ(a.measures.crystalline_percent, 100);
  EXPECT_DOUBLE_EQ(a.measures.fcc_percent, 100);
  EXPECT_EQ(a.measures.crystallites, 1U);
  EXPECT_EQ(a.measures.largest_crystallite, a.measures.interior_grains);
}

TEST(Measures, JammedPackingInATiltedRoughCell) {
  const Packing p = jammed(900, true, 0.08, 53);
  const Analysis a = analyse(checkpoint_of(p, 0.08));
  const Measures& m = a.measures;
  EXPECT_GT(m.phi, 0.5);
  EXPECT_LT(m.phi, 0.7405);
  EXPECT_GT(m.phi_uncorrected, m.phi);
  EXPECT_LT(m.crystalline_percent, 20);
  EXPECT_GT(m.contacts_per_grain, 4);
  EXPECT_LT(m.contacts_per_grain, 9);
  for (std::size_t i = 0; i < a.grains.q6.size(); ++i) {
    EXPECT_GE(a.grains.q6[i], 0);
    EXPECT_LE(a.grains.q6[i], 1);
    EXPECT_DOUBLE_EQ(a.grains.phi_local[i],
                     local_packing_fraction(a.grains.largest_overlap[i], a.grains.cell_volume[i]));
    EXPECT_TRUE(a.grains.crystallites.label[i] < 0 || a.grains.interior[i] == 1);
  }
  const Measures again = measure(checkpoint_of(p, 0.08));
  EXPECT_EQ(again.phi, m.phi);
  EXPECT_EQ(again.mean_overlap, m.mean_overlap);
}

}  // namespace
}  // namespace shearcell::testing
