// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/near_grains.hpp"

#include <cmath>

#include "core/contact.hpp"
#include "core/linked_cells.hpp"

namespace shearcell {

void for_each_pair(
    const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites, double reach,
    const std::function<void(std::int32_t, std::int32_t, const Eigen::Vector3d&)>& visit) {
  const auto count = static_cast<std::int32_t>(sites.cols());
  const auto untilted = [&](std::int32_t s) {
    return sites(0, s) - pose.tan_theta * (sites(1, s) - pose.top);
  };
  LinkedCells near(cell.width, pose.bottom, pose.top, cell.depth,
                   reach * std::sqrt(1 + pose.tan_theta * pose.tan_theta),
                   static_cast<std::size_t>(count));
  for (std::int32_t i = 0; i < count; ++i) {
    near.for_each_near(untilted(i), sites(1, i), sites(2, i), [&](std::int32_t j) {
      Eigen::Vector3d r = sites.col(i) - sites.col(j);
      r.z() = nearest_image(r.z(), cell.depth, 1 / cell.depth);
      if (r.squaredNorm() <= reach * reach) visit(j, i, -r);
    });
    near.insert(i, untilted(i), sites(1, i), sites(2, i));
  }
}

}  // namespace shearcell
