// SPDX-License-Identifier: GPL-3.0-or-later
// A convex polyhedron cut by planes: known volumes, and planes that only touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "analysis/clip.hpp"
#include "analysis/error.hpp"

namespace shearcell::test {
namespace {

std::array<HalfSpace, 6> cube(double half) {
  return {plane_at({-1, 0, 0}, half), plane_at({1, 0, 0}, half),  plane_at({0, -1, 0}, half),
          plane_at({0, 1, 0}, half),  plane_at({0, 0, -1}, half), plane_at({0, 0, 1}, half)};
}

TEST(ConvexCell, PlanesThatOnlyTouchDoNotCut) {
  ConvexCell cell;
  cell.reset(cube(0.5));
  EXPECT_FALSE(cell.clip(bisector_to({1, 0, 0})));  // a face
  EXPECT_FALSE(cell.clip(bisector_to({1, 1, 0})));  // an edge
  EXPECT_FALSE(cell.clip(bisector_to({1, 1, 1})));  // a corner
  EXPECT_EQ(cell.corners(), 8U);
}

TEST(ConvexCell, CornerCutOff) {
  ConvexCell cell;
  cell.reset(cube(1));
  ASSERT_TRUE(cell.clip(plane_at(Eigen::Vector3d(1, 1, 1).normalized(), 2 / std::sqrt(3.0))));
  std::vector<double> areas;
  EXPECT_NEAR(cell.measure(areas), 8 - 1.0 / 6, 1e-15);
  EXPECT_NEAR(areas[6], std::sqrt(3.0) / 2, 1e-15);
  EXPECT_NEAR(areas[1], 3.5, 1e-15);
}

TEST(ConvexCell, NothingLeft) {
  ConvexCell cell;
  cell.reset(cube(1));
  EXPECT_TRUE(cell.clip(plane_at({1, 0, 0}, -2)));
  EXPECT_EQ(cell.corners(), 0U);
  std::vector<double> areas;
  EXPECT_EQ(cell.measure(areas), 0);
}

TEST(ConvexCell, RejectsMorePlanesThanItCanHold) {
  ConvexCell cell;
  cell.reset(cube(2));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto cut_by_spheres_planes = [&] {
    for (int n = 0; n < 5000; ++n) {
      const Eigen::Vector3d direction(normal(random), normal(random), normal(random));
      cell.clip(plane_at(direction.normalized(), 1));
    }
  };
  EXPECT_THROW(cut_by_spheres_planes(), AnalysisError);
}

TEST(ConvexCell, OctahedronOfManyEqualPlanes) {
  // Eight planes cut the cube to an octahedron whose corners each lie on four planes; cutting by
  // the same planes again, in any order, changes nothing.
  ConvexCell cell;
  cell.reset(cube(1));
  for (int round = 0; round < 2; ++round) {
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3d site((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1,
                                 (k & 4) != 0 ? 1 : -1);
      EXPECT_EQ(cell.clip(bisector_to(2.0 / 3 * site)), round == 0);
    }
  }
  std::vector<double> areas;
  EXPECT_NEAR(cell.measure(areas), 4.0 / 3, 1e-14);
}

TEST(ConvexCell, OrderOfCutsDoesNotMatter) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<HalfSpace> planes;
  for (int k = 0; k < 300; ++k) {
    planes.push_back(
        plane_at(Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized(), 1));
  }
  std::vector<double> areas;
  double first = 0;
  for (int round = 0; round < 5; ++round) {
    ConvexCell cell;
    cell.reset(cube(3));
    for (const HalfSpace& plane : planes) cell.clip(plane);
    const double volume = cell.measure(areas);
    if (round == 0) first = volume;
    EXPECT_NEAR(volume, first, 1e-13);
    // Every plane touches the unit ball, so the volume is a third of the surface.
    EXPECT_NEAR(volume, std::accumulate(areas.begin(), areas.end(), 0.0) / 3, 1e-13);
    std::shuffle(planes.begin(), planes.end(), random);
  }
}

}  // namespace
}  // namespace shearcell::test
