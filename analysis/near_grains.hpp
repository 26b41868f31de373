// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of grains within a given distance, whether they touch or not.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "core/cell.hpp"
#include "core/contact.hpp"
#include "core/linked_cells.hpp"

namespace shearcell {

/// Calls visit(i, j, r) for each pair i < j of `sites` (3 x n [d], z unwrapped) that is at most
/// `reach` [d] apart. r is the vector to i from the periodic image of j that is nearest to i. Only
/// this image is visited, so `reach` must not exceed half the depth of the cell.
template <class Visit>
void for_each_pair(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites,
                   double reach, const Visit& visit) {
  const auto count = static_cast<std::int32_t>(sites.cols());
  LinkedCells near(cell, pose, reach, static_cast<std::size_t>(count));
  for (std::int32_t i = 0; i < count; ++i) {
    near.for_each_near(sites.col(i), [&](std::int32_t j) {
      Eigen::Vector3d r = sites.col(i) - sites.col(j);
      r.z() = nearest_image(r.z(), cell.depth, 1 / cell.depth);
      if (r.squaredNorm() <= reach * reach) visit(j, i, Eigen::Vector3d(-r));
    });
    near.insert(i, sites.col(i));
  }
}

}  // namespace shearcell
