// SPDX-License-Identifier: GPL-3.0-or-later
// The cell and the loose grains that every run starts from.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/filling.hpp"
#include "tests/core/scenes.hpp"
#include "tests/support/text.hpp"

namespace shearcell {
namespace {

Geometry of(std::size_t grains) {
  Geometry geometry;
  geometry.grains = grains;
  return geometry;
}

double square_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double depth) {
  Eigen::Vector3d r = a - b;
  r.z() -= depth * std::round(r.z() / depth);
  return r.squaredNorm();
}

TEST(Filling, NoGrainTouchesAnything) {
  const Geometry geometry = of(500);
  const Cell cell = make_cell(geometry, 3);
  const State state = fill_cell(cell, geometry, 3);
  const Eigen::Matrix3Xd walls = wall_grain_positions(cell, wall_pose(cell, 0, state.wall_height));
  ASSERT_EQ(state.position.cols(), 500);
  for (Eigen::Index i = 0; i < 500; ++i) {
    const Eigen::Vector3d p = state.position.col(i);
    EXPECT_GE(std::min({p.x(), cell.width - p.x(), p.y() - cell.bottom, cell.top - p.y()}), 0.5);
    for (Eigen::Index j = 0; j < i; ++j) {
      ASSERT_GE(square_distance(p, state.position.col(j), cell.depth), 1) << i << ' ' << j;
    }
    for (Eigen::Index w = 0; w < walls.cols(); ++w) {
      ASSERT_GE(square_distance(p, walls.col(w), cell.depth), 1) << i << " wall " << w;
    }
  }
}

TEST(Filling, WallGrainsAreDiscsThatDoNotOverlapAtTheStatedDensity) {
  const Cell cell = make_cell(of(600), 1);
  std::array<double, 4> covered{};
  for (std::size_t a = 0; a < cell.wall_grains.size(); ++a) {
    const WallGrain& grain = cell.wall_grains[a];
    covered[static_cast<std::size_t>(grain.side)] += std::numbers::pi / 4;
    const bool upright = grain.side == WallSide::left || grain.side == WallSide::right;
    const double behind = grain.side == WallSide::left     ? -grain.position.x()
                          : grain.side == WallSide::right  ? grain.position.x() - cell.width
                          : grain.side == WallSide::bottom ? cell.bottom - grain.position.y()
                                                           : grain.position.y() - cell.top;
    EXPECT_GE(behind, 0);
    EXPECT_LE(behind, 0.25);
    for (std::size_t b = 0; b < a; ++b) {
      const WallGrain& other = cell.wall_grains[b];
      if (other.side != grain.side) continue;
      Eigen::Vector3d p = grain.position, q = other.position;
      (upright ? p.x() : p.y()) = (upright ? q.x() : q.y()) = 0;
      ASSERT_GE(square_distance(p, q, cell.depth), 1);
    }
  }
  const double side = (cell.top - cell.bottom) * cell.depth;
  const double base = cell.width * cell.depth;
  EXPECT_NEAR(covered[0] / side, 0.52, 0.02);
  EXPECT_NEAR(covered[1] / side, 0.52, 0.02);
  EXPECT_NEAR(covered[2] / base, 0.52, 0.03);
  EXPECT_NEAR(covered[3] / base, 0.52, 0.03);
}

TEST(Filling, DependsOnSeedNumberAndGeometryAlone) {
  const auto fill = [](const Geometry& geometry, std::uint64_t seed) {
    return fill_cell(make_cell(geometry, seed), geometry, seed).position;
  };
  EXPECT_EQ(fill(of(200), 5), fill(of(200), 5));
  EXPECT_NE(fill(of(200), 5), fill(of(200), 6));
  Geometry top = of(200);
  top.moving = MovingWall::top;
  EXPECT_EQ(fill(top, 5), fill(of(200), 5));
}

TEST(Filling, AnotherDrawHasOtherWallGrainsInTheSameCell) {
  Geometry geometry = of(300);
  const Cell first = make_cell(geometry, 5);
  for (const std::uint32_t draw : {1U, 2U, 1'000'000U}) {
    geometry.wall_grain_draw = draw;
    const Cell other = make_cell(geometry, 5);
    EXPECT_EQ(other.width, first.width);
    EXPECT_EQ(other.top, first.top);
    for (const WallGrain& a : first.wall_grains) {
      for (const WallGrain& b : other.wall_grains) {
        ASSERT_FALSE(a.side == b.side && a.position == b.position) << draw;
      }
    }
    const Cell again = make_cell(geometry, 5);
    ASSERT_EQ(again.wall_grains.size(), other.wall_grains.size());
    for (std::size_t k = 0; k < again.wall_grains.size(); ++k) {
      EXPECT_EQ(again.wall_grains[k].position, other.wall_grains[k].position);
    }
  }
}

TEST(Filling, WidthHoldsTheGrainsAtTheNominalFraction) {
  // Smooth walls: L^3 * 1.675 * 0.64 = N pi/6.
  Geometry geometry = of(5200);
  geometry.walls = WallTexture::smooth;
  EXPECT_NEAR(std::pow(cell_width(geometry), 3), 5200 * std::numbers::pi / 6 / (0.64 * 1.675),
              1e-9 * 5200);
  EXPECT_GT(cell_width(of(5200)), cell_width(geometry));
}

TEST(Filling, CellsOfAnyShapeHoldTheGrainsAtTheNominalFraction) {
  for (const double ratio : {0.1, 0.3, 0.8, 1.0, 1.675, 100.0}) {
    for (const WallTexture walls : {WallTexture::rough, WallTexture::smooth}) {
      Geometry geometry = of(5200);
      geometry.walls = walls;
      geometry.height_over_width = ratio;
      const double layers = walls == WallTexture::rough ? 0.35 : 0, width = cell_width(geometry);
      const double free = (width - layers) * (ratio * width - layers) * width;
      EXPECT_NEAR(free * 0.64 / (5200 * std::numbers::pi / 6), 1, 1e-12) << ratio;
    }
  }
}

TEST(Filling, RejectsImpossibleCells) {
  Geometry sparse = of(600);
  sparse.fill_packing_fraction = 1e-300;
  EXPECT_THROW(make_cell(sparse, 1), GeometryError);  // and not an endless placement
  sparse.walls = WallTexture::smooth;
  sparse.fill_packing_fraction = 3e-5;  // no checkpoint of so large a cell could be read
  EXPECT_THROW(make_cell(sparse, 1), GeometryError);
  EXPECT_THROW(make_cell(of(10), 1), GeometryError);  // shallower than 3 d
  Geometry dense = of(300);
  dense.fill_packing_fraction = 0.5;  // beyond what random sequential addition reaches (0.38)
  const Cell full = make_cell(dense, 1);
  EXPECT_THROW(fill_cell(full, dense, 1), GeometryError);
  Geometry flat = of(10);  // lower than a grain even before it settles
  flat.height_over_width = 0.1;
  const Cell low = make_cell(flat, 1);
  test::expect_refused<GeometryError>([&] { fill_cell(low, flat, 1); }, {"height_over_width"});
}

TEST(Filling, StopsIfTheCallerAsks) {
  struct GivenUp {};
  int looks = 0;
  const auto third = [&] {
    if (++looks == 3) throw GivenUp();
  };
  EXPECT_THROW(make_cell(of(5000), 1, third), GivenUp);
  const Cell cell = make_cell(of(5000), 1);
  looks = 0;
  EXPECT_THROW(fill_cell(cell, of(5000), 1, third), GivenUp);
}

TEST(WallGrains, HaveTheVelocityOfTheirPositions) {
  Cell cell{.width = 10, .depth = 4, .bottom = -1, .top = 12};
  for (const WallSide side : {WallSide::left, WallSide::right, WallSide::bottom, WallSide::top}) {
    cell.wall_grains.push_back({side, {1, 3, 2}});
  }
  const double theta = 0.1, tilting = 0.3, height = 0.5, rising = 0.7, dt = 1e-6;
  for (const MovingWall moving : {MovingWall::bottom, MovingWall::top}) {
    cell.moving = moving;
    const auto at = [&](double t) {
      return wall_grain_positions(cell, wall_pose(cell, theta + tilting * t, height + rising * t));
    };
    const WallPose pose = wall_pose(cell, theta, height);
    const double shear_rate = tilting / (pose.cos_theta * pose.cos_theta);
    const Eigen::Matrix3Xd difference = (at(dt) - at(-dt)) / (2 * dt);
    EXPECT_TRUE(wall_grain_velocities(cell, pose, shear_rate, rising).isApprox(difference, 1e-7));
  }
}

}  // namespace
}  // namespace shearcell
