// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles over the height, and how results depend on the criteria of supplement A.
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
  const auto found = measured_by("profiles", {&analysis, &checkpoint}).curves;
  const std::vector<double>& middle = found.at("phi_profile").x;
  ASSERT_EQ(middle.size(), static_cast<std::size_t>(std::ceil(pose.top - pose.bottom)));
  // One layer again, by hand.
  const std::size_t layer = middle.size() / 2;
  EXPECT_EQ(middle[layer], static_cast<double>(layer) + 0.5);
  double volume = 0, trace = 0, contacts = 0, count = 0, hard = 0;
  for (Eigen::Index i = 0; i < checkpoint.state.position.cols(); ++i) {
    const Eigen::Vector3d r = checkpoint.state.position.col(i);
    const Eigen::Vector4d distance = wall_distances(checkpoint.cell, pose, r);
    const double height = r.y() - pose.bottom;
    if (std::min(distance[0], distance[1]) < interior_distance) continue;
    if (height < static_cast<double>(layer) || height >= static_cast<double>(layer) + 1) continue;
    const auto k = static_cast<std::size_t>(i);
    ++count;
    volume += grains.cells.volume[k];
    trace += analysis.mechanics.grain_pressure[k] * grains.cells.volume[k];
    contacts += grains.overlaps.contacts[k];
    hard += std::numbers::pi / 6 * std::pow(1 - grains.overlaps.largest[k], 3);
  }
  ASSERT_GT(count, 5);
  EXPECT_NEAR(found.at("phi_profile").y[layer], hard / volume, 1e-12);
  EXPECT_NEAR(found.at("pressure_profile_Pa").y[layer], trace / volume, 1e-15);
  EXPECT_NEAR(found.at("coordination_profile").y[layer], contacts / count, 1e-12);
}

TEST(Profiles, ALatticeIsTheSameInEveryLayer) {
  Packing p = lattice(Lattice::fcc, 6);
  jitter(p, 0.002, 1);
  const Checkpoint checkpoint = checkpoint_of(p);
  const Analysis analysis = analyse(checkpoint);
  const auto found = measured_by("profiles", {&analysis, &checkpoint}).curves;
  const std::vector<double>& phi = found.at("phi_profile").y;
  for (std::size_t l = 2; l + 2 < phi.size(); ++l) {
    EXPECT_NEAR(phi[l], std::numbers::pi / std::sqrt(18), 0.02);
    EXPECT_EQ(found.at("crystalline_profile_percent").y[l], 100);
  }
}

// Volumes of grains and cells by the distance from the nearest of the four planes, by hand.
TEST(WallDistance, LayersAndCoreAreSumsOverGrains) {
  const Checkpoint checkpoint = checkpoint_of(jammed(3000, true, 0.05, 1));
  const Analysis analysis = analyse(checkpoint);
  const GrainMeasures& grains = analysis.grains;
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
      sums.hard += std::numbers::pi / 6 * std::pow(1 - grains.overlaps.largest[k], 3);
      sums.cells += grains.cells.volume[k];
    };
    add(layers[static_cast<int>(std::floor(2 * distance))]);
    if (distance >= 4) add(inner);
  }
  const MeasuredCurve found =
      measured_by("wall_distance", {&analysis, &checkpoint}).curves.at("phi_by_wall_distance");
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
  const Measures core = measured_by("core", {&analysis, &checkpoint});
  ASSERT_GT(inner.count, 50);
  EXPECT_EQ(core.number("core_grains"), inner.count);
  EXPECT_NEAR(core.number("core_phi"), inner.hard / inner.cells, 1e-12);
}

TEST(WallDistance, ASmallCellHasNoCore) {
  const Checkpoint checkpoint = checkpoint_of(jammed(300, true, 0, 1));
  const Analysis analysis = analyse(checkpoint);
  const Measures none = measured_by("core", {&analysis, &checkpoint});
  EXPECT_EQ(none.numbers.at("core_grains"), 0);
  EXPECT_TRUE(std::isnan(none.numbers.at("core_phi")));
}

TEST(Sensitivity, AtTheChosenCriteriaEqualsTheMeasure) {
  Packing p = lattice(Lattice::fcc, 5);
  jitter(p, 0.012, 3);
  const Checkpoint checkpoint = checkpoint_of(p);
  const Analysis analysis = analyse(checkpoint);
  const auto at = [](const MeasuredCurve& curve, double criterion) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (std::abs(curve.x[i] - criterion) < 1e-12) return curve.y[i];
    }
    return std::nan("");
  };
  const double measured = analysis.measures.crystalline_percent;
  ASSERT_GT(measured, 5);
  ASSERT_LT(measured, 95);
  const auto found = measured_by("sensitivity", {&analysis, &checkpoint}).curves;
  const MeasuredCurve& window = found.at("crystalline_by_q6_window_percent");
  EXPECT_EQ(at(window, q6_tolerance), measured);
  EXPECT_TRUE(std::ranges::is_sorted(window.y));
  const MeasuredCurve& threshold = found.at("crystalline_by_phi_local_percent");
  EXPECT_EQ(at(threshold, crystalline_phi_local), measured);
  EXPECT_TRUE(std::ranges::is_sorted(threshold.y, std::greater<>()));
  const MeasuredCurve& face = found.at("largest_by_face");
  EXPECT_EQ(at(face, connecting_face), static_cast<double>(analysis.measures.largest_crystallite));
  EXPECT_TRUE(std::ranges::is_sorted(face.y, std::greater<>()));
}

}  // namespace
}  // namespace shearcell::test
