// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/near_grains.hpp"

#include "core/contact.hpp"
#include "core/linked_cells.hpp"

namespace shearcell {

void for_each_pair(
    const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites, double reach,
    const std::function<void(std::int32_t, std::int32_t, const Eigen::Vector3d&)>& visit) {
  const auto count = static_cast<std::int32_t>(sites.cols());
  LinkedCells near(cell, pose, reach, static_cast<std::size_t>(count));
  for (std::int32_t i = 0; i < count; ++i) {
    near.for_each_near(sites.col(i), [&](std::int32_t j) {
      Eigen::Vector3d r = sites.col(i) - sites.col(j);
      r.z() = nearest_image(r.z(), cell.depth, 1 / cell.depth);
      if (r.squaredNorm() <= reach * reach) visit(j, i, -r);
    });
    near.insert(i, sites.col(i));
  }
}

}  // namespace shearcell
