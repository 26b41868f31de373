// SPDX-License-Identifier: GPL-3.0-or-later
// q6 of perfect crystals, and what it must not depend on.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "analysis/bond_order.hpp"
#include "analysis/packing_fraction.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::testing {
namespace {

/// Smallest and largest of q6 and phi_local over grains at least two and a half d from the walls.
struct Range {
  double low = 1e9;
  double high = -1e9;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

struct Inside {
  Range q6;
  Range phi;
  int grains = 0;
};

Inside measure_inside(const Packing& p) {
  const VoronoiDiagram d = voronoi(p.cell, p.pose, p.grains);
  const std::vector<double> q6 = bond_order_q6(d);
  Inside inside;
  for (std::size_t i = 0; i < q6.size(); ++i) {
    const Eigen::Vector3d centre = p.grains.col(static_cast<Eigen::Index>(i));
    if (wall_distances(p.cell, p.pose, centre).minCoeff() < 1.7) continue;
    inside.q6.add(q6[i]);
    inside.phi.add(local_packing_fraction(0, d.volume[i]));
    ++inside.grains;
  }
  return inside;
}

void expect_crystal(Lattice kind, double q6, double phi) {
  const Inside inside = measure_inside(lattice(kind, 6));
  EXPECT_GT(inside.grains, 10);
  EXPECT_NEAR(inside.q6.low, q6, 5e-6);
  EXPECT_NEAR(inside.q6.high, q6, 5e-6);
  EXPECT_NEAR(inside.phi.low, phi, 5e-6);
  EXPECT_NEAR(inside.phi.high, phi, 5e-6);
}

TEST(BondOrder, Fcc) {
  expect_crystal(Lattice::fcc, 0.57452, 0.74048);
}
TEST(BondOrder, Hcp) {
  expect_crystal(Lattice::hcp, 0.48476, 0.74048);
}
TEST(BondOrder, SimpleCubic) {
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
    const Inside inside = measure_inside(p);
    EXPECT_NEAR(inside.q6.low, 0.574524, 10 * amplitude + 1e-6);
    EXPECT_NEAR(inside.q6.high, 0.574524, 10 * amplitude + 1e-6);
  }
}

TEST(BondOrder, EqualsTheAdditionTheorem) {
  // (4 pi / 13) sum_m Y_6m(a) Y*_6m(b) = P_6(a . b), so q6^2 is a double sum over bonds.
  const Packing p = jammed(200, false, 0, 47);
  const VoronoiDiagram d = voronoi(p.cell, p.pose, p.grains);
  const std::vector<double> q6 = bond_order_q6(d);
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

}  // namespace
}  // namespace shearcell::testing
