// SPDX-License-Identifier: GPL-3.0-or-later
// Crystalline grains by the criteria of supplement A, and crystallites on known lattices.
#include <gtest/gtest.h>

#include <numeric>

#include "analysis/crystal.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::testing {
namespace {

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
  std::vector<std::uint8_t> crystalline(d.volume.size());
  std::int32_t left = 0;
  std::int32_t right = 0;
  for (std::size_t i = 0; i < crystalline.size(); ++i) {
    const double x = p.grains(0, static_cast<Eigen::Index>(i));
    if (x < 3) ++left;
    if (x > 4.5) ++right;
    crystalline[i] = x < 3 || x > 4.5 ? 1 : 0;
  }
  const Crystallites found = crystallites(d, crystalline, surface);
  EXPECT_EQ(found.size, (std::vector<std::int32_t>{left, right}));
  EXPECT_EQ(found.largest, std::max(left, right));
  for (std::size_t i = 0; i < crystalline.size(); ++i) {
    const double x = p.grains(0, static_cast<Eigen::Index>(i));
    EXPECT_EQ(found.label[i], x < 3 ? 0 : x > 4.5 ? 1 : -1);
  }
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
  const Crystallites found = crystallites(d, crystalline, 6.0);
  EXPECT_EQ(found.size, (std::vector<std::int32_t>{1, 2}));
}

TEST(Crystallites, NoneAtAll) {
  const Packing p = lattice(Lattice::simple_cubic, 3);
  const VoronoiDiagram d = voronoi(p.cell, p.pose, p.grains);
  const Crystallites found = crystallites(d, std::vector<std::uint8_t>(d.volume.size()), 6.0);
  EXPECT_TRUE(found.size.empty());
  EXPECT_EQ(found.largest, 0);
}

}  // namespace
}  // namespace shearcell::testing
