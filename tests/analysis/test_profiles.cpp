// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles over the height, and how results depend on the criteria of supplement A.
#include "analysis/profiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/packing_fraction.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::test {
namespace {

TEST(Profiles, LayersAddUpToTheWhole) {
  const Checkpoint checkpoint = checkpoint_of(jammed(1000, false, 0.05, 1));
  const Analysis analysis = analyse(checkpoint);
  const GrainMeasures& grains = analysis.grains;
  const WallPose pose = pose_of(checkpoint);
  const Profiles found = profiles(checkpoint, grains);
  ASSERT_EQ(found.height.size(), static_cast<std::size_t>(std::ceil(pose.top - pose.bottom)));
  // One layer again, by hand.
  const std::size_t layer = found.height.size() / 2;
  double volume = 0, trace = 0, contacts = 0, count = 0, hard = 0;
  for (Eigen::Index i = 0; i < checkpoint.state.position.cols(); ++i) {
    const Eigen::Vector3d r = checkpoint.state.position.col(i);
    const Eigen::Vector4d distance = wall_distances(checkpoint.cell, pose, r);
    const double height = r.y() - pose.bottom;
    if (std::min(distance[0], distance[1]) < interior_distance) continue;
    if (height < static_cast<double>(layer) || height >= static_cast<double>(layer) + 1) continue;
    const auto k = static_cast<std::size_t>(i);
    ++count;
    volume += grains.cell_volume[k];
    trace += grains.pressure[k] * grains.cell_volume[k];
    contacts += grains.contacts[k];
    hard += std::numbers::pi / 6 * std::pow(1 - grains.largest_overlap[k], 3);
  }
  ASSERT_GT(count, 5);
  EXPECT_NEAR(found.phi[layer], hard / volume, 1e-12);
  EXPECT_NEAR(found.pressure[layer], trace / volume, 1e-15);
  EXPECT_NEAR(found.coordination[layer], contacts / count, 1e-12);
}

TEST(Profiles, ALatticeIsTheSameInEveryLayer) {
  Packing p = lattice(Lattice::fcc, 6);
  jitter(p, 0.002, 1);
  const Checkpoint checkpoint = checkpoint_of(p);
  const Profiles found = profiles(checkpoint, analyse(checkpoint).grains);
  for (std::size_t l = 2; l + 2 < found.height.size(); ++l) {
    EXPECT_NEAR(found.phi[l], std::numbers::pi / std::sqrt(18), 0.02);
    EXPECT_EQ(found.crystalline_percent[l], 100);
  }
}

TEST(Sensitivity, AtTheChosenCriteriaIsWhatIsMeasured) {
  Packing p = lattice(Lattice::fcc, 5);
  jitter(p, 0.012, 3);
  const Checkpoint checkpoint = checkpoint_of(p);
  const Analysis analysis = analyse(checkpoint);
  const auto at = [](const MeasuredCurve& found, double criterion) {
    for (std::size_t i = 0; i < found.x.size(); ++i) {
      if (std::abs(found.x[i] - criterion) < 1e-12) return found.y[i];
    }
    return std::nan("");
  };
  const double measured = analysis.measures.crystalline_percent;
  ASSERT_GT(measured, 5);
  ASSERT_LT(measured, 95);
  const MeasuredCurve window = crystalline_by_window(analysis.grains);
  EXPECT_EQ(at(window, q6_tolerance), measured);
  EXPECT_TRUE(std::ranges::is_sorted(window.y));
  const MeasuredCurve threshold = crystalline_by_phi_local(analysis.grains);
  EXPECT_EQ(at(threshold, crystalline_phi_local), measured);
  EXPECT_TRUE(std::ranges::is_sorted(threshold.y, std::greater<>()));
  const MeasuredCurve face = largest_by_face(checkpoint, analysis.grains);
  EXPECT_EQ(at(face, connecting_face), static_cast<double>(analysis.measures.largest_crystallite));
  EXPECT_TRUE(std::ranges::is_sorted(face.y, std::greater<>()));
}

}  // namespace
}  // namespace shearcell::test
