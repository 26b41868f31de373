// SPDX-License-Identifier: GPL-3.0-or-later
// Common neighbour analysis: perfect and shaken lattices, and packings without order.
#include "analysis/common_neighbours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/measures.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::testing {
namespace {

// Share of a lattice among grains at least 2.5 d from the walls, whose neighbours are all there.
double share(const Packing& p, shearcell::Lattice wanted) {
  const auto found = common_neighbour_analysis(p.cell, p.pose, p.grains);
  double count = 0, of_lattice = 0;
  for (Eigen::Index i = 0; i < p.grains.cols(); ++i) {
    const Eigen::Vector3d r = p.grains.col(i);
    const double x = std::min(r.x(), p.cell.width - r.x());
    const double y = std::min(r.y() - p.pose.bottom, p.pose.top - r.y());
    if (std::min(x, y) < 2.5) continue;
    ++count;
    of_lattice += found[static_cast<std::size_t>(i)] == wanted ? 1 : 0;
  }
  EXPECT_GT(count, 20);
  return of_lattice / count;
}

TEST(CommonNeighbours, PerfectAndShakenLatticesAreClassifiedAsKnown) {
  const std::pair<testing::Lattice, shearcell::Lattice> known[] = {
      {Lattice::fcc, shearcell::Lattice::fcc},
      {Lattice::hcp, shearcell::Lattice::hcp},
      {Lattice::bcc, shearcell::Lattice::bcc},
      {Lattice::simple_cubic, shearcell::Lattice::none}};
  for (const auto& [kind, expected] : known) {
    Packing p = lattice(kind, 8);
    EXPECT_EQ(share(p, expected), 1) << static_cast<int>(kind);
    jitter(p, 0.03, 1);
    EXPECT_EQ(share(p, expected), 1) << static_cast<int>(kind);
  }
}

TEST(CommonNeighbours, APackingWithoutOrderHasHardlyAny) {
  const Packing p = jammed(2000, true, 0.05, 3);
  EXPECT_GT(share(p, shearcell::Lattice::none), 0.97);
}

TEST(CommonNeighbours, AgreesWithQ6WhereThatIsUnambiguous) {
  Packing p = lattice(Lattice::hcp, 6);
  jitter(p, 0.01, 2);
  const Analysis analysis = analyse(p.cell, p.pose, p.grains);
  const auto found = common_neighbour_analysis(p.cell, p.pose, p.grains);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (analysis.grains.interior[i] == 0 || analysis.grains.structure[i] != Structure::hcp) {
      continue;
    }
    ++compared;
    EXPECT_EQ(found[i], shearcell::Lattice::hcp);
  }
  EXPECT_GT(compared, 20U);
}

}  // namespace
}  // namespace shearcell::testing
