// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbour lists and linked cells against brute force, in tilted cells and across the seam.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

#include "core/cell_order.hpp"
#include "core/contact.hpp"
#include "core/linked_cells.hpp"
#include "core/neighbour_lists.hpp"
#include "core/random.hpp"
#include "core/simulation.hpp"
#include "tests/core/random_scenes.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

// Random points of a tilted cell, some a little outside of it, unwrapped in z by several periods,
// some fast.
struct Points {
  AlignedVector<double> rows;
  std::array<std::vector<double>, 3> velocity;
  std::vector<std::int32_t> id;
};

Points random_points(std::size_t grains, const Cell& cell, const WallPose& pose,
                     std::uint64_t seed) {
  Points points;
  points.rows.assign(4 * (padded(grains) + 1 + cell.wall_grains.size()), 0.0);
  points.rows[4 * padded(grains)] = -1e30;
  for (std::size_t g = grains; g < padded(grains); ++g) points.rows[4 * g] = 1e30;
  for (std::uint32_t g = 0; g < grains; ++g) {
    const auto a = uniform_pair({g, 0, 0, 0}, seed);
    const auto b = uniform_pair({g, 1, 0, 0}, seed);
    double* row = points.rows.data() + std::size_t{4} * g;
    row[1] = pose.bottom - 0.2 + a[1] * (pose.top - pose.bottom + 0.4);
    row[0] = -0.2 + a[0] * (cell.width + 0.4) + pose.tan_theta * (row[1] - pose.top);
    row[2] = b[0] * cell.depth + std::floor(5 * b[1] - 2) * cell.depth;
    points.id.push_back(static_cast<std::int32_t>(grains - 1 - g));  // any order
    for (auto& axis : points.velocity) axis.push_back(g % 7 == 0 ? 3 : 0);
  }
  return points;
}

// Of any shape, with wall grains on all walls in mixed order.
Cell any_cell() {
  Cell cell;
  cell.width = any_number("width", 1.5, 9);
  cell.depth = any_number("depth", 3, 7);
  cell.top = any_number("height", 2, 12);
  cell.moving = any_bool("top moves") ? MovingWall::top : MovingWall::bottom;
  const auto wall_grains = *rc::gen::inRange<std::uint32_t>(0, 100).as("wall grains");
  for (std::uint32_t i = 0; i < wall_grains; ++i) {
    const auto u = uniform_pair({i, 2, 0, 0}, 5);
    const double x = cell.width * u[0], y = cell.top * u[0], z = cell.depth * u[1];
    const Eigen::Vector3d centres[4] = {
        {-0.1, y, z}, {cell.width + 0.1, y, z}, {x, -0.1, z}, {x, cell.top + 0.1, z}};
    cell.wall_grains.push_back({static_cast<WallSide>(i % 4), centres[i % 4]});
  }
  return cell;
}

Snapshot snapshot_of(Points& points, const WallPose& pose) {
  Snapshot now;
  now.rows = points.rows.data();
  for (std::size_t axis = 0; axis < 3; ++axis) now.velocity[axis] = points.velocity[axis].data();
  now.grains = points.id.size();
  now.pose = pose;
  now.time_step = 1e-4;
  return now;
}

// Offsets of the sites that should be in the inner list of grain g, by brute force.
std::vector<std::int32_t> expected_row(const Points& points, const Walls& walls, double depth,
                                       std::size_t g) {
  const std::size_t grains = points.id.size();
  const double* p = points.rows.data() + 4 * g;
  std::vector<std::int32_t> row;
  const auto keep_near = [&](std::int32_t offset) {
    const double* q = points.rows.data() + offset;
    const double dz = nearest_image(p[2] - q[2], depth, 1 / depth);
    const double square = std::pow(p[0] - q[0], 2) + std::pow(p[1] - q[1], 2) + dz * dz;
    if (p != q && square < std::pow(1 + p[3] + q[3], 2)) row.push_back(offset);
  };
  for (std::size_t w = 0; w < walls.size(); ++w) {
    keep_near(wall_offset(grains) + static_cast<std::int32_t>(4 * w));
  }
  for (std::size_t id = 0; id < grains; ++id) {
    keep_near(static_cast<std::int32_t>(4 * (grains - 1 - id)));
  }
  return row;
}

// The sites in the inner list of grain g, as the kernel would walk it.
std::vector<std::int32_t> found_row(const NeighbourLists& lists, const Walls& walls,
                                    std::size_t grains, std::size_t lanes, std::size_t g) {
  const NeighbourRows inner = lists.rows();
  const auto moving_end = wall_offset(grains) + static_cast<std::int32_t>(4 * walls.moving_size());
  const std::size_t block = g / lanes;
  std::vector<std::int32_t> row;
  for (std::size_t k = 0;
       k < inner.moving_wall_slots[block] + std::size_t{inner.other_slots[block]}; ++k) {
    const std::int32_t offset = inner.list[inner.begin[block] + k * lanes + g % lanes];
    if (offset == padding_offset(grains)) continue;
    const bool of_moving = offset >= wall_offset(grains) && offset < moving_end;
    RC_ASSERT(of_moving == (k < inner.moving_wall_slots[block]));
    RC_ASSERT(!of_moving || (lists.near()[g] & kNearMovingWall) != 0);
    row.push_back(offset);
  }
  return row;
}

PROPERTY(NeighbourLists, HoldExactlyThePairsWithinTheirMarginsInAscendingId, 300) {
  const Cell cell = any_cell();
  const ListSettings settings = any_settings().lists;
  Walls walls(cell);
  const double moved = any_number("wall moved", 0, 0.3) * cell.top;
  const WallPose pose =
      wall_pose(cell, any_number("theta", -0.4, 0.4),
                cell.moving == MovingWall::bottom ? cell.bottom + moved : cell.top - moved);
  const auto grains = *rc::gen::inRange<std::size_t>(1, 400).as("grains");
  Points points =
      random_points(grains, cell, pose, *rc::gen::inRange<std::uint64_t>(0, 1000).as("seed"));
  const Snapshot now = snapshot_of(points, pose);
  for (const Kernels* kernels : kernels_here()) {
    Team team(1);
    NeighbourLists lists(*kernels, settings, cell.depth, walls, team);
    lists.set_outer_margins(now);
    walls.choose_active(pose, 3);
    std::vector<Site> sites;
    for (const std::int32_t w : walls.active()) sites.push_back({wall_offset(grains) + 4 * w, w});
    for (std::size_t g = 0; g < grains; ++g) {
      sites.push_back({static_cast<std::int32_t>(4 * g),
                       static_cast<std::int32_t>(walls.size()) + points.id[g]});
    }
    CellOrder order;
    order.build(cell, pose, 1 + 2 * settings.widest_margin(cell.depth), points.rows.data(), sites,
                team);
    lists.build(now, points.id, order);
    for (std::size_t g = 0; g < grains; ++g) {
      RC_ASSERT(found_row(lists, walls, grains, kernels->lanes, g) ==
                expected_row(points, walls, cell.depth, g));
    }
  }
}

// A damaged checkpoint can hold such a state. Lists are cut off at kMostNeighbours: grain 0 has
// that many grains of the moving wall, the others of its vector as many grains.
TEST(NeighbourLists, OfACollapsedCellAreTheSameInAllKernels) {
  constexpr std::uint32_t kCrowd = kMostNeighbours + 50;
  const auto near = [](double x, double y, std::uint32_t i) -> Eigen::Vector3d {
    const auto u = uniform_pair({i, 0, 0, 0}, 1);
    return {x + 0.1 * u[0], y + 0.1 * u[1], 2 + 0.1 * uniform_pair({i, 1, 0, 0}, 1)[0]};
  };
  Cell cell;
  cell.width = cell.top = 8;
  cell.depth = 4;
  State state;
  state.position.resize(3, 1 + kCrowd);
  state.velocity.setZero(3, 1 + kCrowd);
  state.position.col(0) = Eigen::Vector3d(2, 0.6, 2);
  for (std::uint32_t i = 0; i < kCrowd; ++i) {
    cell.wall_grains.push_back({WallSide::bottom, near(2, -0.1, i)});
    state.position.col(1 + i) = near(6, 4, i);
  }
  Scene scene;
  scene.stiffness = 1;
  SimulationSettings settings;
  settings.lists.sort_memory = false;
  settings.kernels = &scalar_kernels();
  const Eigen::Matrix3Xd expected = Simulation(cell, scene, state, settings).forces().on_grain;
  EXPECT_GT(expected(1, 0), 100);  // a thousand overlaps of about 0.3 d
  for (const Kernels* kernels : kernels_here()) {
    settings.kernels = kernels;
    EXPECT_EQ(Simulation(cell, scene, state, settings).forces().on_grain, expected)
        << kernels->name;
  }
}

TEST(Reference, AnAffineShearIsNoMotion) {
  Cell cell;
  cell.width = cell.depth = cell.top = 10;
  const Points points = random_points(64, cell, wall_pose(cell, 0, 0), 3);
  Reference reference;
  Team team(2);
  reference.set(points.rows.data(), 64, wall_pose(cell, 0, 0), 0.2, team);
  const double rounding = reference.margin_loss(0);
  EXPECT_LT(rounding, 1e-4);
  Points sheared = points;
  const WallPose pose = wall_pose(cell, 0.05, 0);
  for (std::size_t g = 0; g < 64; ++g) {
    double* p = sheared.rows.data() + 4 * g;
    p[0] += pose.tan_theta * (p[1] - pose.top);
  }
  for (std::size_t g = 0; g < 64; ++g) {
    EXPECT_LT(reference.moved(sheared.rows.data(), g, pose), rounding);
  }
  // Two grains 1.4 apart along the direction that shrinks most, e/2 of a distance.
  EXPECT_GT(reference.margin_loss(pose.tan_theta), 1.4 * 0.5 * pose.tan_theta / 2);
  sheared.rows[4 * 17 + 2] += 0.25;
  EXPECT_NEAR(reference.moved(sheared.rows.data(), 17, pose), 0.25, rounding);
}

TEST(Grid, NeighboursOfEveryCellInStripsOfAnyWidth) {
  for (const std::int32_t layers : {1, 2, 3, 4, 7, 10}) {
    for (std::int32_t strip = 1; strip <= layers; ++strip) {
      Grid grid;
      grid.columns = 4;
      grid.layers = layers;
      grid.rows = 5;
      grid.strip = strip;
      std::map<std::size_t, std::array<std::int32_t, 3>> cell_at;  // column, row, layer
      for (std::int32_t row = 0; row < grid.rows; ++row) {
        for (std::int32_t layer = 0; layer < layers; ++layer) {
          for (std::int32_t column = 0; column < grid.columns; ++column) {
            const std::int32_t at = grid.line_of(row, layer) * grid.columns + column;
            ASSERT_GE(at, 0);
            ASSERT_LT(static_cast<std::size_t>(at), grid.size());
            cell_at[static_cast<std::size_t>(at)] = {column, row, layer};
          }
        }
      }
      ASSERT_EQ(cell_at.size(), grid.size());  // each place once
      for (const auto& [at, own] : cell_at) {
        std::multiset<std::size_t> expected, found;
        for (const auto& [other_at, other] : cell_at) {
          const std::int32_t dz = std::abs(own[2] - other[2]);
          const bool near = std::abs(own[0] - other[0]) <= 1 && std::abs(own[1] - other[1]) <= 1 &&
                            std::min(dz, layers - dz) <= 1;
          if (near) expected.insert(other_at);
        }
        std::array<CellRange, 9> ranges;
        const std::size_t count = grid.surrounding(static_cast<std::uint32_t>(at), ranges);
        for (std::size_t r = 0; r < count; ++r) {
          for (std::size_t p = ranges[r].begin; p < ranges[r].end; ++p) found.insert(p);
        }
        ASSERT_EQ(found, expected) << layers << " layers in strips of " << strip << ", " << at;
      }
    }
  }
}

TEST(LinkedCells, VisitEveryPointNearbyOnceInShallowCellsToo) {
  for (const double depth : {1.0, 2.0, 3.0, 3.9, 7.0}) {
    LinkedCells near({.width = 4, .depth = depth}, {.top = 4}, 1.0, 50);
    for (std::int32_t i = 0; i < 50; ++i) {
      const auto u = uniform_pair({static_cast<std::uint32_t>(i), 0, 0, 0}, 5);
      near.insert(i, {4 * u[0], 4 * u[1], depth * (i % 7) / 7.0});
    }
    std::multiset<std::int32_t> seen;
    near.for_each_near({2, 2, 0.1}, [&](std::int32_t i) { seen.insert(i); });
    for (const std::int32_t i : seen) EXPECT_EQ(seen.count(i), 1U) << depth;
    for (std::int32_t i = 0; i < 50; ++i) {
      const auto u = uniform_pair({static_cast<std::uint32_t>(i), 0, 0, 0}, 5);
      const double dz = std::remainder(depth * (i % 7) / 7.0 - 0.1, depth);
      const bool is_near = std::hypot(4 * u[0] - 2, 4 * u[1] - 2, dz) <= 1;
      EXPECT_TRUE(!is_near || seen.contains(i)) << i << ", " << depth;
    }
    EXPECT_FALSE(seen.empty());
    // Coordinates that are not finite belong to some cell.
    near.insert(50, {std::nan(""), 1e300, -1e300});
  }
}

}  // namespace
}  // namespace shearcell
