// SPDX-License-Identifier: GPL-3.0-or-later
// Overlaps, volume fractions and interior grains compared with numbers worked out by hand;
// test_mechanics.cpp compares overlaps with sums over all pairs.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "analysis/packing_fraction.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::test {
namespace {

TEST(PackingFraction, HandComputedExample) {
  const std::vector<double> overlap = {0.1, 0.0, 0.5};
  const std::vector<double> volume = {1.0, 2.0, 7.0};
  const std::vector<std::uint8_t> selected = {1, 1, 0};
  const PackingFractions f = packing_fractions(overlap, volume, selected);
  EXPECT_NEAR(f.phi, std::numbers::pi / 6 * (0.729 + 1) / 3, 1e-15);
  EXPECT_NEAR(f.phi_uncorrected, std::numbers::pi / 6 * 2 / 3, 1e-15);
  EXPECT_NEAR(local_packing_fraction(0.1, 1.0), std::numbers::pi / 6 * 0.729, 1e-15);
  const std::vector<std::uint8_t> none(3);
  EXPECT_TRUE(std::isnan(packing_fractions(overlap, volume, none).phi));
}

TEST(Overlaps, ChainThroughThePeriodicBoundary) {
  Packing p = empty_cell(4, 4, 3);
  p.grains.resize(3, 3);
  p.grains.col(0) << 2, 2, 0.2;
  p.grains.col(1) << 2, 2, 1.1;   // overlap 0.1 with grain 0
  p.grains.col(2) << 2, 2, -0.6;  // overlap 0.2 with grain 0; 1.3 from grain 1 around the back
  const Overlaps o = overlaps(p.cell, p.pose, p.grains);
  EXPECT_NEAR(o.mean, 0.15, 1e-15);
  EXPECT_NEAR(o.largest[0], 0.2, 1e-15);
  EXPECT_NEAR(o.largest[1], 0.1, 1e-15);
  EXPECT_EQ(o.contacts, (std::vector<std::int32_t>{2, 1, 1}));
}

TEST(Overlaps, WallGrainsCountForTheGrainButNotForTheMean) {
  Packing p = empty_cell(4, 4, 3);
  p.cell.wall_grains.push_back({WallSide::left, {-0.2, 2, 1}});
  p.grains.resize(3, 1);
  p.grains.col(0) << 0.5, 2, 1;  // touches the plane behind, and overlaps the wall grain by 0.3
  const Overlaps o = overlaps(p.cell, p.pose, p.grains);
  EXPECT_EQ(o.mean, 0);
  EXPECT_EQ(o.contacts[0], 1);
  EXPECT_NEAR(o.largest[0], 0.3, 1e-15);
}

TEST(Interior, ByWallTextureAndTilt) {
  Packing p = empty_cell(6, 6, 5);
  p.grains.resize(3, 4);
  p.grains.col(0) << 1.49, 3, 0;
  p.grains.col(1) << 1.51, 3, 0;
  p.grains.col(2) << 3, 4.2, 0;
  p.grains.col(3) << 3, 3, 0;
  using Flags = std::vector<std::uint8_t>;
  EXPECT_EQ(interior_grains(p.cell, p.pose, p.grains), (Flags{0, 1, 1, 1}));
  p.cell.wall_grains.push_back({WallSide::left, {0, 2, 1}});
  EXPECT_EQ(interior_grains(p.cell, p.pose, p.grains), (Flags{0, 0, 0, 1}));
  p.cell.wall_grains.clear();
  p.pose = wall_pose(p.cell, 0.1, 0);  // at half height the side walls are 3 tan(0.1) further left
  const double along_normal = 1.5 / std::cos(0.1) - 3 * std::tan(0.1);
  p.grains(0, 0) = along_normal - 1e-9;
  p.grains(0, 1) = along_normal + 1e-9;
  EXPECT_EQ(interior_grains(p.cell, p.pose, p.grains), (Flags{0, 1, 1, 1}));
}

}  // namespace
}  // namespace shearcell::test
