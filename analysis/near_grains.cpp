// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/near_grains.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

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

NearGrains::NearGrains(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites,
                       std::size_t count, double reach)
    : first_(count + 1, 0) {
  struct Pair {
    std::int32_t i, j;
    Eigen::Vector3d r;
  };
  std::vector<Pair> pairs;
  const auto wanted = [&](std::int32_t i) { return static_cast<std::size_t>(i) < count; };
  for_each_pair(cell, pose, sites, reach, [&](std::int32_t i, std::int32_t j, const auto& r) {
    if (!wanted(i)) return;
    pairs.push_back({i, j, r});
    ++first_[static_cast<std::size_t>(i) + 1];
    if (wanted(j)) ++first_[static_cast<std::size_t>(j) + 1];
  });
  for (std::size_t i = 0; i < count; ++i) first_[i + 1] += first_[i];
  near_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (const Pair& pair : pairs) {
    const double distance = pair.r.norm();
    near_[next[static_cast<std::size_t>(pair.i)]++] = {pair.j, distance, -pair.r};
    if (wanted(pair.j))
      near_[next[static_cast<std::size_t>(pair.j)]++] = {pair.i, distance, pair.r};
  }
  const auto by_distance = [](const NearGrain& a, const NearGrain& b) {
    return std::tie(a.distance, a.index) < std::tie(b.distance, b.index);
  };
  for (std::size_t i = 0; i < count; ++i) {
    std::sort(near_.begin() + static_cast<std::ptrdiff_t>(first_[i]),
              near_.begin() + static_cast<std::ptrdiff_t>(first_[i + 1]), by_distance);
  }
}

}  // namespace shearcell
