// SPDX-License-Identifier: GPL-3.0-or-later
// Displacements and D^2_min of known motions.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "analysis/measures.hpp"
#include "core/contact.hpp"
#include "provenance/errors.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::test {
namespace {

/// Displacement [d] and D^2_min [d^2] of each grain.
struct Moved {
  std::vector<double> displacement, nonaffine;
};
Moved moved_between(const Checkpoint& earlier, const Checkpoint& later) {
  const auto before = [&] { return &earlier; };
  const auto found = measured_by("grain_motion", {nullptr, &later, before}).of_grains;
  return {found.at("displacement_d"), found.at("d2min_d2")};
}

TEST(Motion, IsZeroInACellThatIsOnlySheared) {
  const Packing p = jammed(400, false, 0, 1);
  const Checkpoint upright = checkpoint_of(p);
  Checkpoint tilted = upright;
  tilted.theta = 0.1;
  const WallPose pose = pose_of(tilted);
  tilted.state.position.row(0).array() +=
      pose.tan_theta * (tilted.state.position.row(1).array() - pose.top);
  const Moved moved = moved_between(upright, tilted);
  EXPECT_LT(std::ranges::max(moved.displacement), 1e-12);
  for (const double nonaffine : moved.nonaffine) EXPECT_LT(nonaffine, 1e-12);
}

TEST(Motion, AnAffineDeformationIsNotNonaffine) {
  const Packing p = jammed(400, false, 0.05, 2);
  const Checkpoint earlier = checkpoint_of(p);
  Checkpoint later = earlier;
  // Without z, in which the cell is periodic: the deformation of a pair across it would jump.
  Eigen::Matrix3d deformation;
  deformation << 1.02, 0.03, 0, -0.01, 0.97, 0, 0.02, 0.01, 1;
  later.state.position =
      (deformation * earlier.state.position).colwise() + Eigen::Vector3d(1, 2, 3);
  const Moved moved = moved_between(earlier, later);
  for (const double nonaffine : moved.nonaffine) EXPECT_LT(nonaffine, 1e-12);
  EXPECT_GT(std::ranges::min(moved.displacement), 1);
}

// By the normal equations of Falk and Langer, over all pairs.
double brute_force(const Checkpoint& earlier, const Checkpoint& later, Eigen::Index i) {
  const auto between = [&](const Checkpoint& c, Eigen::Index j) {
    Eigen::Vector3d r = c.state.position.col(j) - c.state.position.col(i);
    r.z() = nearest_image(r.z(), c.cell.depth, 1 / c.cell.depth);
    return r;
  };
  const double neighbour = provider("grain_motion").parameters.at("neighbour_d");
  std::vector<Eigen::Index> near;
  for (Eigen::Index j = 0; j < earlier.state.position.cols(); ++j) {
    if (j != i && between(earlier, j).norm() <= neighbour) near.push_back(j);
  }
  Eigen::MatrixXd before(3, static_cast<Eigen::Index>(near.size())), after = before;
  for (std::size_t k = 0; k < near.size(); ++k) {
    before.col(static_cast<Eigen::Index>(k)) = between(earlier, near[k]);
    after.col(static_cast<Eigen::Index>(k)) = between(later, near[k]);
  }
  const Eigen::MatrixXd affine =
      before.transpose().colPivHouseholderQr().solve(after.transpose()).transpose();
  return (after - affine * before).squaredNorm() / static_cast<double>(near.size());
}

TEST(Motion, NonaffineMotionIsThatOfALeastSquaresFit) {
  Packing p = jammed(400, false, 0, 3);
  const Checkpoint earlier = checkpoint_of(p);
  jitter(p, 0.1, 4);
  const Checkpoint later = checkpoint_of(p);
  const Moved moved = moved_between(earlier, later);
  for (Eigen::Index i = 0; i < p.grains.cols(); i += 7) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(moved.nonaffine[k], brute_force(earlier, later, i), 1e-12);
    EXPECT_NEAR(moved.displacement[k],
                (later.state.position.col(i) - earlier.state.position.col(i)).norm(), 1e-15);
  }
}

TEST(Motion, GrainsInOnePlaneHaveNoDeformation) {
  Packing p = empty_cell(6, 6, 6);
  p.grains.resize(3, 9);
  for (int i = 0; i < 9; ++i) p.grains.col(i) = Eigen::Vector3d(2 + i % 3, 2 + i / 3, 3);
  const Checkpoint flat = checkpoint_of(p);
  for (const double nonaffine : moved_between(flat, flat).nonaffine) {
    EXPECT_TRUE(std::isnan(nonaffine));
  }
  Checkpoint fewer = flat;
  fewer.state.position.conservativeResize(3, 8);
  EXPECT_THROW(moved_between(flat, fewer), AnalysisError);
}

TEST(Motion, MeansAreOverTheRightGrains) {
  Packing p = lattice(Lattice::fcc, 5);
  jitter(p, 0.005, 1);
  const Checkpoint earlier = checkpoint_of(p);
  const Analysis analysis = analyse(earlier);
  ASSERT_GT(analysis.measures.crystalline_percent, 50);
  // All move by 0.02 d, except one interior grain.
  Checkpoint later = earlier;
  later.state.position.row(2).array() += 0.02;
  std::size_t still = 0;
  while (analysis.grains.interior[still] == 0) ++still;
  later.state.position(2, static_cast<Eigen::Index>(still)) -= 0.02;
  const Measures m = measured_by("motion", {&analysis, &later, [&] { return &earlier; }});
  const auto interior = static_cast<double>(analysis.measures.interior_grains);
  EXPECT_NEAR(m.numbers.at("msd_1_cycle_d2"), 4e-4 * (interior - 1) / interior, 1e-15);
  EXPECT_NEAR(m.numbers.at("reversible_percent"), 100 / interior, 1e-12);
  EXPECT_GT(m.numbers.at("d2min_1_cycle_d2"), 0);
  EXPECT_TRUE(std::isnan(m.number("msd_10_cycles_d2"))) << "there is no such checkpoint";
  const auto none = []() -> const Checkpoint* { return nullptr; };
  EXPECT_TRUE(measured_by("motion_10", {&analysis, &later, none}).numbers.empty());
}

TEST(Motion, TheBoundaryOfACrystalHasOtherNeighbours) {
  Packing p = empty_cell(8, 8, 8);
  p.grains.resize(3, 4);
  for (int i = 0; i < 4; ++i) p.grains.col(i) = Eigen::Vector3d(2 + i, 4, 7.9);
  p.grains(2, 3) = 0.1;  // a neighbour across the periodic boundary
  const Checkpoint earlier = checkpoint_of(p);
  for (int i = 0; i < 4; ++i) p.grains(2, i) += 0.01 * (i + 1);
  const Checkpoint later = checkpoint_of(p);
  Analysis analysis;
  analysis.grains.interior.assign(4, 1);
  analysis.grains.structure.assign(4, Structure::fcc);
  analysis.grains.structure.back() = Structure::disordered;
  const auto before = [&] { return &earlier; };
  const Measures m = measured_by("motion", {&analysis, &later, before});
  EXPECT_NEAR(m.number("msd_inside_crystal_d2"), (1e-4 + 4e-4) / 2, 1e-12);
  EXPECT_NEAR(m.number("msd_crystal_boundary_d2"), 9e-4, 1e-12);
  EXPECT_NEAR(m.number("msd_disordered_d2"), 16e-4, 1e-12);
}

}  // namespace
}  // namespace shearcell::test
