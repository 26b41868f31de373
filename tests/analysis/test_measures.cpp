// SPDX-License-Identifier: GPL-3.0-or-later
// All measures of one packing. None depends on where the periodic seam is or on the orientation of
// a crystal.
#include "analysis/measures.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "provenance/errors.hpp"
#include "tests/analysis/random_points.hpp"

namespace shearcell::test {
namespace {

TEST(Measures, PerfectCrystal) {
  const Packing p = lattice(Lattice::fcc, 6);
  const Analysis a = analyse(checkpoint_of(p));
  EXPECT_EQ(a.measures.grains, static_cast<std::size_t>(p.grains.cols()));
  EXPECT_GT(a.measures.interior_grains, 100U);
  EXPECT_NEAR(a.measures.phi_uncorrected, 0.74048, 5e-6);
  EXPECT_NEAR(a.measures.phi, 0.74048, 5e-6);
  EXPECT_DOUBLE_EQ(a.measures.crystalline_percent, 100);
  EXPECT_DOUBLE_EQ(a.measures.fcc_percent, 100);
  EXPECT_EQ(a.measures.crystallites, 1U);
  EXPECT_EQ(a.measures.largest_crystallite, a.measures.interior_grains);
}

TEST(Measures, RejectACellInWhichAGrainTouchesItsImage) {
  Packing p = lattice(Lattice::fcc, 3);
  for (const double depth : {1e-6, 0.9, std::nan("")}) {
    p.cell.depth = depth;
    EXPECT_THROW(analyse(checkpoint_of(p)), AnalysisError) << depth;
  }
}

bool near(double a, double b, double tolerance) {
  return (std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= tolerance;
}

bool near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [=](double x, double y) { return near(x, y, tolerance); });
}

// By steps that a double holds exactly, so that grains that just touch still do.
void move_along_z(Packing& p) {
  const double shift = *rc::gen::inRange(-4000, 4000).as("1024 shift") / 1024.0;
  for (WallGrain& grain : p.cell.wall_grains) grain.position.z() += shift;
  for (Eigen::Index i = 0; i < p.grains.cols(); ++i) {
    p.grains(2, i) += shift + static_cast<double>(i % 5 - 2) * p.cell.depth;
  }
}

PROPERTY(Measures, DoNotDependOnThePeriodicSeam, 250) {
  Packing p = any_points();
  const Analysis a = analyse(checkpoint_of(p));
  for (std::size_t i = 0; i < a.grains.interior.size(); ++i) {
    RC_ASSERT(a.grains.crystallite[i] < 0 || a.grains.interior[i] == 1);
  }
  move_along_z(p);
  const Analysis b = analyse(checkpoint_of(p));
  RC_ASSERT(near(a.grains.cells.volume, b.grains.cells.volume, 1e-10));
  RC_ASSERT(near(a.grains.cells.surface, b.grains.cells.surface, 1e-9));
  RC_ASSERT(near(a.grains.overlaps.largest, b.grains.overlaps.largest, 1e-12));
  RC_ASSERT(near(a.grains.phi_local, b.grains.phi_local, 1e-9));
  RC_ASSERT(near(a.grains.q6, b.grains.q6, 1e-6));  // near 0 it is the root of a rounding error
  RC_ASSERT(a.grains.interior == b.grains.interior);
  RC_ASSERT(a.grains.structure == b.grains.structure);
  RC_ASSERT(a.grains.crystallite == b.grains.crystallite);
  RC_ASSERT(near(a.measures.phi, b.measures.phi, 1e-10));
  RC_ASSERT(near(a.measures.phi_uncorrected, b.measures.phi_uncorrected, 1e-10));
  RC_ASSERT(near(a.measures.mean_overlap_d, b.measures.mean_overlap_d, 1e-12));
  RC_ASSERT(a.measures.contacts_per_grain == b.measures.contacts_per_grain);
}

double any_coordinate() {
  return *rc::gen::inRange(-1000, 1001) / 1000.0;
}

PROPERTY(BondOrder, IsUnchangedByRotation, 1000) {
  std::vector<VoronoiFace> faces;
  double surface = *rc::gen::inRange(0, 100) / 100.0;  // of wall planes
  for (int i = *rc::gen::inRange(1, 25).as("faces"); i > 0; --i) {
    const Eigen::Vector3d to(any_coordinate(), any_coordinate(), any_coordinate());
    RC_PRE(to.norm() > 0.01);
    const double area = *rc::gen::inRange(1, 1000) / 1000.0;
    faces.push_back(
        {to, area, i, *rc::gen::element(NeighbourKind::grain, NeighbourKind::wall_grain)});
    surface += area;
  }
  const double before = bond_order_q6(faces, surface);
  RC_ASSERT(before >= 0);
  RC_ASSERT(before <= 1 + 1e-12);
  Eigen::Quaterniond turn(any_coordinate(), any_coordinate(), any_coordinate(), any_coordinate());
  RC_PRE(turn.norm() > 0.01);
  turn.normalize();
  for (VoronoiFace& face : faces) face.to_neighbour = turn * face.to_neighbour;
  const double after = bond_order_q6(faces, surface);
  RC_ASSERT(near(before * before, after * after, 1e-13));
}

}  // namespace
}  // namespace shearcell::test
