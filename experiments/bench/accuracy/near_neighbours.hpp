// SPDX-License-Identifier: GPL-3.0-or-later
// Bond order from cheaper neighbours than Voronoi's, to see what they cost in accuracy. Evidence;
// no figure uses it.
#pragma once

#include <cstddef>
#include <vector>

#include "core/cell.hpp"

namespace shearcell::accuracy {

/// Whose bonds count, each alike: all within a distance [d], or the nearest so many of those within
/// 1.6 d.
struct NeighbourRule {
  double cutoff = 1.4;
  std::size_t most = 0;  ///< 0 for all
};

/// q6 of every grain over its neighbours, grains and wall grains; 0 for a grain without any.
std::vector<double> q6_of_near(const Cell& cell, const WallPose& pose,
                               const Eigen::Matrix3Xd& grains, const NeighbourRule& rule);

/// Against the Voronoi cells of the product.
struct OrderError {
  double q6 = 0;       ///< root mean square over interior grains
  double percent = 0;  ///< crystalline interior grains, minus the Voronoi percentage
};

/// Interior grains whose q6 is near that of FCC or HCP count as crystalline; a rule without Voronoi
/// cells knows no local packing fraction, so that criterion is left out of its own percentage
/// alone.
OrderError order_error(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains,
                       const NeighbourRule& rule);

}  // namespace shearcell::accuracy
