// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles over the height, and how results depend on the criteria of supplement A.
#include "analysis/profiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
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

// Volumes of grains and cells by the distance from the nearest of the four planes, by hand.
TEST(WallDistance, LayersAndCoreAreSumsOverGrains) {
  const Checkpoint checkpoint = checkpoint_of(jammed(3000, true, 0.05, 1));
  const GrainMeasures grains = analyse(checkpoint).grains;
  const WallPose pose = pose_of(checkpoint);
  struct Sums {
    double count = 0, hard = 0, cells = 0;
  };
  std::map<int, Sums> layers;
  Sums inner;
  for (Eigen::Index i = 0; i < checkpoint.state.position.cols(); ++i) {
    const Eigen::Vector3d r = checkpoint.state.position.col(i);
    const double left = (r.y() - pose.top) * pose.tan_theta;
    const double side = std::min(r.x() - left, left + checkpoint.cell.width - r.x());
    const double distance =
        std::min({side * pose.cos_theta, r.y() - pose.bottom, pose.top - r.y()}) - 0.375;
    const auto k = static_cast<std::size_t>(i);
    const auto add = [&](Sums& sums) {
      ++sums.count;
      sums.hard += std::numbers::pi / 6 * std::pow(1 - grains.largest_overlap[k], 3);
      sums.cells += grains.cell_volume[k];
    };
    add(layers[static_cast<int>(std::floor(2 * distance))]);
    if (distance >= 4) add(inner);
  }
  const MeasuredCurve found = phi_by_wall_distance(checkpoint, grains);
  ASSERT_GT(found.x.size(), 8U);
  for (std::size_t l = 0; l < found.x.size(); ++l) {
    EXPECT_EQ(found.x[l], 0.25 + 0.5 * static_cast<double>(l));
    const Sums& sums = layers[static_cast<int>(l)];
    if (sums.count > 0) {
      EXPECT_NEAR(found.y[l], sums.hard / sums.cells, 1e-12);
    } else {
      EXPECT_TRUE(std::isnan(found.y[l]));
    }
  }
  const Core measured = core(checkpoint, grains);
  ASSERT_GT(inner.count, 50);
  EXPECT_EQ(measured.grains, inner.count);
  EXPECT_NEAR(measured.phi, inner.hard / inner.cells, 1e-12);
}

TEST(WallDistance, ASmallCellHasNoCore) {
  const Checkpoint checkpoint = checkpoint_of(jammed(300, true, 0, 1));
  const Core none = core(checkpoint, analyse(checkpoint).grains);
  EXPECT_EQ(none.grains, 0);
  EXPECT_TRUE(std::isnan(none.phi));
}

TEST(Sensitivity, AtTheChosenCriteriaEqualsTheMeasure) {
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
