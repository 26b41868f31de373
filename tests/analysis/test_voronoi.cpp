// SPDX-License-Identifier: GPL-3.0-or-later
// Voronoi cells fill the sheared box, agree with each other across faces, and with voro++.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "analysis/crystal.hpp"
#include "provenance/errors.hpp"
#include "tests/analysis/oracles.hpp"
#include "tests/analysis/packings.hpp"
#include "tests/analysis/random_points.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Largest difference of the two areas that two grains see of their common face.
double worst_reciprocity(const VoronoiDiagram& d) {
  double worst = 0;
  for (std::size_t i = 0; i < d.volume.size(); ++i) {
    for (const VoronoiFace& face : d.faces_of(i)) {
      if (face.kind != NeighbourKind::grain) continue;
      double other = 0;
      for (const VoronoiFace& back : d.faces_of(static_cast<std::size_t>(face.neighbour))) {
        if (back.kind == NeighbourKind::grain && back.neighbour == static_cast<std::int32_t>(i) &&
            (back.to_neighbour + face.to_neighbour).norm() < 1e-9) {
          other = back.area;
        }
      }
      worst = std::max(worst, std::abs(face.area - other));
    }
  }
  return worst;
}

VoronoiDiagram cells_of(const Packing& p) {
  return voronoi(p.cell, p.pose, p.grains);
}

void expect_agrees_with_voro(const Packing& p) {
  const VoronoiDiagram d = cells_of(p);
  const std::vector<double> q6 = q6_of(d);
  const std::vector<VoroCell> cells = voro_cells(p);
  const auto grains = static_cast<int>(p.grains.cols());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_NEAR(d.volume[i], cells[i].volume, 1e-9);
    EXPECT_NEAR(d.surface[i], cells[i].surface, 1e-9);
    EXPECT_NEAR(q6[i], cells[i].q6, 1e-8);
    std::set<int> neighbours;
    for (const VoronoiFace& face : d.faces_of(i)) {
      if (face.kind == NeighbourKind::wall_plane || face.area < 1e-10) continue;
      neighbours.insert(face.neighbour + (face.kind == NeighbourKind::grain ? 0 : grains));
    }
    EXPECT_EQ(neighbours, cells[i].neighbours) << "grain " << i;
  }
}

/// Largest sum of area times outward normal over the faces of a cell: 0 for a closed surface.
double worst_opening(const VoronoiDiagram& d) {
  double worst = 0;
  for (std::size_t i = 0; i < d.volume.size(); ++i) {
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    for (const VoronoiFace& face : d.faces_of(i)) {
      total += face.area * face.to_neighbour.normalized();
    }
    worst = std::max(worst, total.norm());
  }
  return worst;
}

/// Whether the cells fill the box. Wall grains also have cells, which take a part of it.
bool fills_the_box(const Packing& p, const VoronoiDiagram& d, double tolerance = 1e-12) {
  const double share = sum(d.volume) / volume_of(p);
  return share < 1 + tolerance && (share > 1 - tolerance || !p.cell.wall_grains.empty());
}

/// The cells fill the box, are closed, and agree across their faces.
void expect_sound(const Packing& p, double tolerance = 1e-11) {
  const VoronoiDiagram d = cells_of(p);
  EXPECT_TRUE(fills_the_box(p, d)) << sum(d.volume) / volume_of(p);
  EXPECT_LT(worst_reciprocity(d), tolerance);
  EXPECT_LT(worst_opening(d), tolerance);
}

PROPERTY(Voronoi, CellsOfAnyPointsFillTheCellAndShareTheirFaces, 300) {
  const Packing p = any_points();
  const VoronoiDiagram d = cells_of(p);
  RC_ASSERT(fills_the_box(p, d, 1e-11));
  RC_ASSERT(worst_reciprocity(d) < 1e-10);
  RC_ASSERT(worst_opening(d) < 1e-10);
  for (std::size_t i = 0; i < d.volume.size(); ++i) {
    double surface = 0;
    for (const VoronoiFace& face : d.faces_of(i)) surface += face.area;
    RC_ASSERT(d.volume[i] > 0);
    RC_ASSERT(std::abs(surface - d.surface[i]) < 1e-10);
  }
}

TEST(Voronoi, JammedPackingsAgreeWithVoro) {
  for (const double theta : {0.0, 0.1}) {
    for (const bool rough : {false, true}) {
      SCOPED_TRACE("theta " + std::to_string(theta) + (rough ? " rough" : " smooth"));
      const Packing p = jammed(700, rough, theta, 5);
      expect_sound(p);
      expect_agrees_with_voro(p);
    }
  }
}

TEST(Voronoi, LatticesWhereManySitesShareOneSphere) {
  for (const Lattice kind : {Lattice::simple_cubic, Lattice::bcc, Lattice::fcc, Lattice::hcp}) {
    for (const double amplitude : {0.0, 1e-15, 1e-12, 1e-9, 1e-4, 0.05}) {
      SCOPED_TRACE("lattice " + std::to_string(static_cast<int>(kind)) + " jitter " +
                   std::to_string(amplitude));
      Packing p = lattice(kind, 4);
      jitter(p, amplitude, 17);
      expect_sound(p);
    }
  }
}

TEST(Voronoi, AffinelyShearedLattice) {
  for (const double theta : {0.05, 0.1, std::atan(0.5)}) {
    Packing p = lattice(Lattice::fcc, 4);
    p.pose = wall_pose(p.cell, theta, 0);
    for (auto grain : p.grains.colwise()) grain.x() += (grain.y() - p.pose.top) * p.pose.tan_theta;
    expect_sound(p);
  }
}

TEST(Voronoi, CoplanarAndCollinearSites) {
  Packing p = empty_cell(8, 8, 2);
  p.grains.resize(3, 49);
  for (int i = 0; i < 49; ++i) {
    const int column = i % 7, row = i / 7;
    p.grains.col(i) << 1 + column, 1 + row, 0.25;
  }
  expect_sound(p);
  p.grains.conservativeResize(3, 7);
  expect_sound(p);
  p.grains.conservativeResize(3, 1);
  const VoronoiDiagram alone = cells_of(p);
  EXPECT_DOUBLE_EQ(alone.volume[0], 128);
  EXPECT_EQ(alone.faces.size(), 6U);
}

TEST(Voronoi, SitesOnOneSphereAroundAGrain) {
  for (const int sites : {200, 1000}) {
    Packing p = empty_cell(8, 8, 8);
    p.grains.resize(3, sites + 1);
    p.grains.col(0) << 4, 4, 4;
    std::mt19937_64 random(19);
    std::normal_distribution<double> normal;
    for (int i = 1; i <= sites; ++i) {
      const Eigen::Vector3d direction(normal(random), normal(random), normal(random));
      p.grains.col(i) = p.grains.col(0) + 2 * direction.normalized();
    }
    expect_sound(p, 1e-10);
    EXPECT_EQ(cells_of(p).faces_of(0).size(), static_cast<std::size_t>(sites));
  }
}

/// A cube of 2 d with a grain in its centre and a wall grain at `offset` from the grain.
Packing cube_with_wall_grain(const Eigen::Vector3d& offset) {
  Packing p = empty_cell(2, 2, 2);
  p.grains = Eigen::Vector3d(1, 1, 1);
  p.cell.wall_grains.push_back({WallSide::right, p.grains.col(0) + offset});
  return p;
}

TEST(Voronoi, AWallGrainCutsOffAnEdgeOfTheBox) {
  for (const double x : {-1.5, 1.5}) {
    for (const double y : {-1.5, 1.5}) {
      const Packing p = cube_with_wall_grain({x, y, 0});
      const VoronoiDiagram d = cells_of(p);
      EXPECT_NEAR(d.volume[0], 7.75, 1e-14);
      const auto faces = d.faces_of(0);
      ASSERT_EQ(faces.size(), 7U);  // two images, the wall grain, four walls
      EXPECT_NEAR(faces[0].area, 3.875, 1e-14);
      EXPECT_NEAR(faces[1].area, 3.875, 1e-14);
      EXPECT_EQ(faces[2].kind, NeighbourKind::wall_grain);
      EXPECT_NEAR(faces[2].area, std::sqrt(2.0), 1e-14);
      const std::array<bool, 4> cut = {x<0, x> 0, y<0, y> 0};
      for (std::size_t wall = 0; wall < 4; ++wall) {
        const VoronoiFace& face = faces[3 + wall];
        EXPECT_EQ(face.kind, NeighbourKind::wall_plane);
        EXPECT_EQ(face.neighbour, static_cast<int>(wall));
        EXPECT_NEAR(face.area, cut[wall] ? 3 : 4, 1e-14);
        EXPECT_DOUBLE_EQ(face.to_neighbour.norm(), 2);
      }
    }
  }
}

// The bisector touches the cell along a whole wall, along an edge of the box, or not at all.
TEST(Voronoi, WallGrainsThatOnlyTouchAddNoFace) {
  const std::vector<Eigen::Vector3d> offsets = {{2, 0, 0}, {-2, 0, 0}, {0, 2, 0}, {0, -2, 0},
                                                {2, 2, 0}, {-2, 2, 0}, {3, 3, 1}};
  for (const Eigen::Vector3d& offset : offsets) {
    SCOPED_TRACE(testing::PrintToString(offset));
    const VoronoiDiagram d = voronoi(cube_with_wall_grain(offset).cell, empty_cell(2, 2, 2).pose,
                                     Eigen::Vector3d(1, 1, 1));
    EXPECT_NEAR(d.volume[0], 8, 1e-14);
    ASSERT_EQ(d.faces.size(), 6U);
    for (std::size_t f = 2; f < 6; ++f) EXPECT_EQ(d.faces[f].kind, NeighbourKind::wall_plane);
  }
}

/// `count` grains anywhere between the walls.
void scatter(Packing& p, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  p.grains.resize(3, count);
  for (auto grain : p.grains.colwise()) {
    grain.y() = p.pose.bottom + share(random) * (p.pose.top - p.pose.bottom);
    grain.x() = share(random) * p.cell.width + (grain.y() - p.pose.top) * p.pose.tan_theta;
    grain.z() = share(random) * p.cell.depth;
  }
}

TEST(Voronoi, FewGrainsInFlatAndLongCells) {
  const std::vector<Eigen::Vector3d> sizes = {{6, 0.01, 6}, {0.01, 6, 6}, {6, 6, 0.05},
                                              {300, 3, 2},  {3, 300, 2},  {2, 3, 300}};
  for (const Eigen::Vector3d& size : sizes) {
    for (const double theta : {0.0, 0.4}) {
      for (const int grains : {1, 2, 4, 40}) {
        SCOPED_TRACE(testing::PrintToString(size) + " theta " + std::to_string(theta) + " grains " +
                     std::to_string(grains));
        Packing p = empty_cell(size.x(), size.y(), size.z(), theta);
        scatter(p, grains, 29);
        expect_sound(p, 1e-9);
      }
    }
  }
}

TEST(Voronoi, GrainsCloseToAWall) {
  for (const double distance : {1e-3, 1e-6, 1e-9, 1e-13}) {
    for (const double theta : {0.0, 0.2}) {
      Packing p = empty_cell(5, 5, 5, theta);
      scatter(p, 100, 31);
      for (int i = 0; i < 60; ++i) {
        if (i < 20) p.grains(1, i) = distance;
        const double shift = (p.grains(1, i) - p.pose.top) * p.pose.tan_theta;
        if (i < 40) p.grains(0, i) = 0.07 * (i + 1) + shift;
        if (i >= 20) p.grains(0, i) = (i < 40 ? distance : 5 - distance) + shift;
      }
      expect_sound(p);
    }
  }
}

TEST(Voronoi, TheOrderOfGrainsDoesNotMatter) {
  Packing p = jammed(300, true, 0.2, 3);
  const VoronoiDiagram d = cells_of(p);
  std::vector<int> order(300);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(7));
  const VoronoiDiagram shuffled =
      voronoi(p.cell, p.pose, Eigen::Matrix3Xd(p.grains(Eigen::all, order)));
  for (std::size_t i = 0; i < 300; ++i) {
    const auto from = static_cast<std::size_t>(order[i]);
    EXPECT_NEAR(shuffled.volume[i], d.volume[from], 1e-13);
    EXPECT_NEAR(shuffled.surface[i], d.surface[from], 1e-12);
    EXPECT_EQ(shuffled.faces_of(i).size(), d.faces_of(from).size());
  }
}

TEST(Voronoi, AShallowCellSeesItsOwnImages) {
  for (const double depth : {0.3, 0.9, 1.7}) {
    Packing p = empty_cell(6, 6, depth);
    fill(p, 30, 0, 23);
    EXPECT_TRUE(fills_the_box(p, cells_of(p)));
  }
}

std::string message_of(const Packing& p) {
  return test::message_of<AnalysisError>([&] { cells_of(p); });
}

TEST(Voronoi, NamesGrainsAtOnePlace) {
  Packing p = jammed(200, false, 0, 37);
  p.cell.wall_grains.push_back({WallSide::left, p.grains.col(150) + Eigen::Vector3d(1e-13, 0, 0)});
  EXPECT_EQ(message_of(p), "grain 150 and wall grain 0 lie at the same place");
  p.cell.wall_grains.clear();
  p.grains.col(150) = p.grains.col(12);
  p.grains(2, 150) += p.cell.depth;
  EXPECT_EQ(message_of(p), "grain 12 and grain 150 lie at the same place");
}

// In a region without grains, cells see images from farther away than in a packing.
TEST(Voronoi, AVoidAcrossThePeriodicBoundary) {
  Packing p = empty_cell(9, 9, 9);
  fill(p, 700, 0, 59);
  for (double& z : p.grains.row(2)) z = 3 + 3 * (z / 9 - std::floor(z / 9));
  expect_sound(p);
  expect_agrees_with_voro(p);
}

TEST(Voronoi, NamesTheGrainOutside) {
  Packing p = jammed(200, false, 0.1, 41);
  p.grains(1, 33) = -0.25;
  EXPECT_EQ(message_of(p), "grain 33 lies outside the cell: 0.250000 d beyond the bottom wall");
  p.grains(1, 33) = std::nan("");
  EXPECT_EQ(message_of(p), "grain 33 has no finite position");
  p.grains(1, 33) = 1;
  p.cell.wall_grains.push_back({WallSide::left, {0, std::nan(""), 0}});
  EXPECT_EQ(message_of(p), "a wall grain has no finite position");
  p.pose.bottom = p.pose.top;
  EXPECT_EQ(message_of(p), "the cell has no volume");
}

}  // namespace
}  // namespace shearcell::test
