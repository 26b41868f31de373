// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbour lists and linked cells against brute force, in tilted cells and across the seam.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/contact.hpp"
#include "core/linked_cells.hpp"
#include "core/neighbour_lists.hpp"
#include "core/random.hpp"

namespace shearcell {
namespace {

struct Points {
  AlignedVector<double> rows;
  std::vector<std::int32_t> id;
};

// Random points of a tilted cell, some a little outside of it, unwrapped in z by several periods.
Points random_points(std::size_t grains, const Cell& cell, const WallPose& pose,
                     std::uint64_t seed) {
  Points points;
  points.rows.assign(4 * (padded(grains) + 1), 0.0);
  points.rows[4 * padded(grains)] = -1e30;
  for (std::size_t g = grains; g < padded(grains); ++g) points.rows[4 * g] = 1e30;
  for (std::uint32_t g = 0; g < grains; ++g) {
    const auto a = uniform_pair({g, 0, 0, 0}, seed);
    const auto b = uniform_pair({g, 1, 0, 0}, seed);
    double* row = points.rows.data() + 4 * g;
    row[1] = pose.bottom - 0.2 + a[1] * (pose.top - pose.bottom + 0.4);
    row[0] = -0.2 + a[0] * (cell.width + 0.4) + pose.tan_theta * (row[1] - pose.top);
    row[2] = b[0] * cell.depth + std::floor(5 * b[1] - 2) * cell.depth;
    points.id.push_back(static_cast<std::int32_t>(grains - 1 - g));  // any order
  }
  return points;
}

TEST(NeighbourLists, HoldExactlyThePairsWithinTheCutoffsInAscendingId) {
  Cell cell;
  cell.width = 6;
  cell.depth = 5;
  cell.top = 9;
  for (const double theta : {0.0, 0.1, -0.3}) {
    const std::size_t grains = 301;
    const WallPose pose = wall_pose(cell, theta, 1.5);
    const Points points = random_points(grains, cell, pose, 11);
    ListSettings settings;
    CellOrder order;
    order.build(cell, pose, settings.outer_cutoff, points.rows.data(), points.id);
    for (const Simd simd : {Simd::scalar, Simd::avx2, Simd::avx512}) {
      const Kernels* kernels = find_kernels(simd);
      if (kernels == nullptr) continue;
      Team team(1);
      NeighbourLists lists(*kernels, settings, cell.depth, team);
      lists.build(points.rows.data(), points.id, order, pose);
      lists.prune(points.rows.data(), grains, pose);
      const NeighbourRows inner = lists.rows();
      for (std::size_t g = 0; g < grains; ++g) {
        std::vector<std::int32_t> expected;
        for (std::int32_t id = 0; id < static_cast<std::int32_t>(grains); ++id) {
          const std::size_t j = grains - 1 - static_cast<std::size_t>(id);
          const double* p = points.rows.data() + 4 * g;
          const double* q = points.rows.data() + 4 * j;
          const double dz = nearest_image(p[2] - q[2], cell.depth, 1 / cell.depth);
          const double square = std::pow(p[0] - q[0], 2) + std::pow(p[1] - q[1], 2) + dz * dz;
          if (j != g && square < std::pow(settings.inner_cutoff, 2)) {
            expected.push_back(static_cast<std::int32_t>(4 * j));
          }
        }
        std::vector<std::int32_t> found;
        for (std::size_t k = 0; k < inner.slots[g / kernels->lanes]; ++k) {
          const std::size_t lanes = kernels->lanes;
          const std::int32_t offset = inner.list[inner.begin[g / lanes] + k * lanes + g % lanes];
          if (offset != padding_offset(grains)) found.push_back(offset);
        }
        ASSERT_EQ(found, expected) << kernels->name << " grain " << g << " theta " << theta;
      }
    }
  }
}

TEST(NeighbourLists, AnAffineShearAloneCostsNoSkin) {
  Cell cell;
  cell.width = cell.depth = cell.top = 10;
  const Points points = random_points(64, cell, wall_pose(cell, 0, 0), 3);
  Reference reference;
  reference.set(points.rows.data(), 64, wall_pose(cell, 0, 0));
  Points sheared = points;
  const WallPose pose = wall_pose(cell, 0.05, 0);
  for (std::size_t g = 0; g < 64; ++g) {
    double* p = sheared.rows.data() + 4 * g;
    p[0] += pose.tan_theta * (p[1] - pose.top);
  }
  EXPECT_LT(reference.farthest(sheared.rows.data(), 64, pose), reference.rounding());
  EXPECT_LT(reference.rounding(), 1e-4);
  EXPECT_LT(reference.stretch(pose), 1);
  sheared.rows[4 * 17 + 2] += 0.25;
  EXPECT_NEAR(reference.farthest(sheared.rows.data(), 64, pose), 0.25, reference.rounding());
}

TEST(LinkedCells, VisitEveryPointNearbyOnceInShallowCellsToo) {
  for (const double depth : {1.0, 2.0, 3.0, 3.9, 7.0}) {
    LinkedCells near(4, 0, 4, depth, 1.0, 50);
    for (std::int32_t i = 0; i < 50; ++i) {
      const auto u = uniform_pair({static_cast<std::uint32_t>(i), 0, 0, 0}, 5);
      near.insert(i, 4 * u[0], 4 * u[1], depth * (i % 7) / 7.0);
    }
    std::multiset<std::int32_t> seen;
    near.for_each_near(2, 2, 0.1, [&](std::int32_t i) { seen.insert(i); });
    for (const std::int32_t i : seen) EXPECT_EQ(seen.count(i), 1U) << depth;
    EXPECT_FALSE(seen.empty());
    // Wild coordinates land somewhere, and nothing breaks.
    near.insert(50, std::nan(""), 1e300, -1e300);
  }
}

}  // namespace
}  // namespace shearcell
