// SPDX-License-Identifier: GPL-3.0-or-later
// q6 and common neighbours of crystals and of disorder, the criteria of supplement A, crystallites.
#include "analysis/crystal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "analysis/packing_fraction.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::test {
namespace {

/// q6 and phi_local of the grains at least 1.7 d from the walls.
struct Inside {
  std::vector<double> q6, phi;
};

Inside measure_inside(const Packing& p) {
  const VoronoiDiagram d = voronoi(p.cell, p.pose, p.grains);
  const std::vector<double> q6 = q6_of(d);
  Inside inside;
  for (std::size_t i = 0; i < q6.size(); ++i) {
    const Eigen::Vector3d centre = p.grains.col(static_cast<Eigen::Index>(i));
    if (wall_distances(p.cell, p.pose, centre).minCoeff() < 1.7) continue;
    inside.q6.push_back(q6[i]);
    inside.phi.push_back(local_packing_fraction(0, d.volume[i]));
  }
  EXPECT_GT(inside.q6.size(), 10U);
  return inside;
}

void expect_crystal(Lattice kind, double q6, double phi) {
  const Inside inside = measure_inside(lattice(kind, 6));
  for (const double found : inside.q6) EXPECT_NEAR(found, q6, 5e-6);
  for (const double found : inside.phi) EXPECT_NEAR(found, phi, 5e-6);
}

TEST(BondOrder, OfLattices) {
  expect_crystal(Lattice::fcc, 0.57452, 0.74048);
  expect_crystal(Lattice::hcp, 0.48476, 0.74048);
  expect_crystal(Lattice::simple_cubic, 0.353553, 0.523599);
}

TEST(BondOrder, BccByItsTwoKindsOfFace) {
  // Truncated octahedron of edge e: 8 hexagons (3 sqrt3 / 2) e^2 along <111>, 6 squares e^2 along
  // <100>. The cubic harmonic of degree 6 is 16/9 along <111> times its value along <100>.
  const double hexagons = 12 * std::sqrt(3.0) / (6 + 12 * std::sqrt(3.0));
  const double q6 = std::sqrt(1.0 / 8) * (hexagons * 16 / 9 + (1 - hexagons));
  expect_crystal(Lattice::bcc, q6, 0.680175);
}

TEST(BondOrder, SlightJitterMovesItSlightly) {
  for (const double amplitude : {1e-10, 1e-5, 1e-3}) {
    Packing p = lattice(Lattice::fcc, 6);
    jitter(p, amplitude, 3);
    for (const double q6 : measure_inside(p).q6) EXPECT_NEAR(q6, 0.574524, 10 * amplitude + 1e-6);
  }
}

TEST(BondOrder, EqualsTheAdditionTheorem) {
  // (4 pi / 13) sum_m Y_6m(a) Y*_6m(b) = P_6(a . b), so q6^2 is a double sum over bonds.
  const Packing p = jammed(200, false, 0, 47);
  const VoronoiDiagram d = voronoi(p.cell, p.pose, p.grains);
  const std::vector<double> q6 = q6_of(d);
  for (std::size_t i = 0; i < q6.size(); ++i) {
    double square = 0;
    for (const VoronoiFace& a : d.faces_of(i)) {
      for (const VoronoiFace& b : d.faces_of(i)) {
        if (a.kind == NeighbourKind::wall_plane || b.kind == NeighbourKind::wall_plane) continue;
        const double c = a.to_neighbour.normalized().dot(b.to_neighbour.normalized());
        const double c2 = c * c;
        square += a.area * b.area * (((231 * c2 - 315) * c2 + 105) * c2 - 5) / 16;
      }
    }
    EXPECT_NEAR(q6[i], std::sqrt(std::max(square, 0.0)) / d.surface[i], 1e-7);
  }
}

TEST(Structure, CriteriaOfSupplementA) {
  EXPECT_EQ(structure(0.74, 0.575), Structure::fcc);
  EXPECT_EQ(structure(0.74, 0.594), Structure::fcc);
  EXPECT_EQ(structure(0.74, 0.596), Structure::disordered);
  EXPECT_EQ(structure(0.74, 0.485), Structure::hcp);
  EXPECT_EQ(structure(0.74, 0.466), Structure::hcp);
  EXPECT_EQ(structure(0.74, 0.53), Structure::disordered);
  EXPECT_EQ(structure(0.72, 0.575), Structure::disordered);
}

TEST(Crystallites, TwoBlocksOfALatticeApart) {
  const Packing p = lattice(Lattice::fcc, 6);
  const VoronoiDiagram d = voronoi(p.cell, p.pose, p.grains);
  const double surface = std::accumulate(d.surface.begin(), d.surface.end(), 0.0) /
                         static_cast<double>(d.surface.size());
  // Grains in two slabs with more than one lattice plane between them.
  std::vector<std::uint8_t> crystalline;
  std::vector<std::int32_t> label;
  for (const double x : p.grains.row(0)) {
    label.push_back(x < 3 ? 0 : x > 4.5 ? 1 : -1);
    crystalline.push_back(label.back() < 0 ? 0 : 1);
  }
  EXPECT_EQ(crystallites(d, crystalline, connecting_face * surface), label);
  const CrystalliteMap map = crystallite_map(label, p.cell, p.pose, p.grains);
  EXPECT_EQ(map.size,
            (std::vector<std::int32_t>{static_cast<std::int32_t>(std::ranges::count(label, 0)),
                                       static_cast<std::int32_t>(std::ranges::count(label, 1))}));
  EXPECT_EQ(map.largest(), std::ranges::max(map.size));
}

TEST(Crystallites, SliversDoNotConnect) {
  // In a simple cubic lattice, sites across the diagonal of a square share no face; a slight jitter
  // gives them slivers.
  Packing p = lattice(Lattice::simple_cubic, 6);
  jitter(p, 1e-3, 5);
  const VoronoiDiagram d = voronoi(p.cell, p.pose, p.grains);
  std::vector<std::uint8_t> crystalline(d.volume.size());
  const auto id = [](std::size_t x, std::size_t y, std::size_t z) { return (x * 6 + y) * 6 + z; };
  crystalline[id(2, 2, 2)] = 1;
  crystalline[id(3, 3, 2)] = 1;
  crystalline[id(3, 3, 3)] = 1;
  const std::vector<std::int32_t> label = crystallites(d, crystalline, 0.06);
  EXPECT_EQ(crystallite_map(label, p.cell, p.pose, p.grains).size,
            (std::vector<std::int32_t>{1, 2}));
  const std::vector<std::int32_t> none =
      crystallites(d, std::vector<std::uint8_t>(crystalline.size()), 0.06);
  EXPECT_EQ(crystallite_map(none, p.cell, p.pose, p.grains).largest(), 0);
}

TEST(CrystalliteMap, CentresOfMassAcrossTheSeamOfATiltedCell) {
  Cell cell;
  cell.width = 10;
  cell.depth = 8;
  cell.top = 20;
  const WallPose pose = wall_pose(cell, 0.1, 0);
  const std::vector<std::int32_t> two = {0, 0, -1, 1};
  Eigen::Matrix3Xd r(3, 4);
  r.col(0) = Eigen::Vector3d(4, 10, 0.5);
  r.col(1) = Eigen::Vector3d(5, 12, 7.7);
  r.col(2) = Eigen::Vector3d(1, 1, 1);
  r.col(3) = Eigen::Vector3d(6, 20, 3);
  const CrystalliteMap map = crystallite_map(two, cell, pose, r);
  EXPECT_EQ(map.grain, (std::vector<std::int32_t>{0, 1, 3}));
  EXPECT_NEAR(map.centre[0].x(), 4.5 + 9 * std::tan(0.1), 1e-12);
  EXPECT_NEAR(map.centre[0].y(), 11, 1e-12);
  EXPECT_NEAR(map.centre[0].z(), 0.1, 1e-12);
  EXPECT_NEAR((map.centre[1] - r.col(3)).norm(), 0, 1e-12) << "at the top nothing is displaced";
}

// Share of a lattice (0 none, 1 FCC, 2 HCP, 3 BCC) among grains at least 2.5 d from the walls,
// whose neighbours are all there.
double share(const Packing& p, double wanted) {
  const Checkpoint checkpoint = checkpoint_of(p);
  const std::vector<double> found =
      measured_by("grain_lattices", {nullptr, &checkpoint}).of_grains.at("lattice");
  double count = 0, of_lattice = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector3d centre = p.grains.col(static_cast<Eigen::Index>(i));
    if (wall_distances(p.cell, p.pose, centre).minCoeff() < 2.5) continue;
    ++count;
    of_lattice += found[i] == wanted ? 1 : 0;
  }
  EXPECT_GT(count, 20);
  return of_lattice / count;
}

TEST(CommonNeighbours, PerfectAndShakenLatticesAreClassifiedCorrectly) {
  const std::pair<Lattice, double> known[] = {
      {Lattice::fcc, 1}, {Lattice::hcp, 2}, {Lattice::bcc, 3}, {Lattice::simple_cubic, 0}};
  for (const auto& [kind, expected] : known) {
    Packing p = lattice(kind, 8);
    EXPECT_EQ(share(p, expected), 1) << static_cast<int>(kind);
    jitter(p, 0.03, 1);
    EXPECT_EQ(share(p, expected), 1) << static_cast<int>(kind);
  }
}

TEST(CommonNeighbours, ADisorderedPackingHasHardlyAny) {
  const Packing p = jammed(2000, true, 0.05, 3);
  EXPECT_GT(share(p, 0), 0.97);
}

}  // namespace
}  // namespace shearcell::test
