// SPDX-License-Identifier: GPL-3.0-or-later
// The same Voronoi cells by voro++.
#pragma once

#include <set>
#include <vector>

#include "tests/analysis/packings.hpp"

namespace shearcell::test {

struct VoroCell {
  double volume;
  double surface;
  double q6;  ///< by the C++ library's spherical harmonics, term by term as in Eq. S1
  std::set<int>
      neighbours;  ///< grains and wall grains (ids from n on) beyond faces of 1e-10 or more
};

/// All grains' cells by voro++, with wall planes and wall grains.
std::vector<VoroCell> voro_cells(const Packing& packing);

/// Processor time of this thread [s]: other work on the machine disturbs it little.
double thread_seconds();

/// Thread seconds that voro++ takes for volumes, neighbours and face areas of all grains' cells,
/// with the given mean number of sites in each of its blocks.
double time_voro(const Packing& packing, double sites_per_block);

}  // namespace shearcell::test
