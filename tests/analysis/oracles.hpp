// SPDX-License-Identifier: GPL-3.0-or-later
// The same Voronoi cells by other hands: voro++ for sizes and q6, CGAL's Delaunay triangulation for
// neighbours.
#pragma once

#include <set>
#include <vector>

#include "tests/analysis/packings.hpp"

namespace shearcell::testing {

struct VoroCell {
  double volume;
  double surface;
  double q6;  ///< by the C++ library's spherical harmonics, term by term as in Eq. S1
};

/// All grains' cells by voro++, with wall planes and wall grains.
std::vector<VoroCell> voro_cells(const Packing& packing);

/// Processor time of this thread [s]: other work on the machine disturbs it little.
double thread_seconds();

/// Thread seconds that voro++ takes for volumes, neighbours and face areas of all grains' cells,
/// with the given mean number of sites in each of its blocks.
double time_voro(const Packing& packing, double sites_per_block);

/// Neighbours of each grain among grains and wall grains (ids from n on) in CGAL's Delaunay
/// triangulation of the sites and their z-images; right for grains well inside the walls.
std::vector<std::set<int>> delaunay_neighbours(const Packing& packing);

}  // namespace shearcell::testing
