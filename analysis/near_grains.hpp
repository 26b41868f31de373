// SPDX-License-Identifier: GPL-3.0-or-later
// Grains near grains, whether they touch or not.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/cell.hpp"

namespace shearcell {

/// Calls visit(i, j, r) for every pair i < j of `sites` (3 x n [d], z unwrapped) that are at most
/// `reach` [d] apart, with r from j's nearest image to i. `reach` must not exceed half the depth
/// of the cell, beyond which images would be missed.
void for_each_pair(
    const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites, double reach,
    const std::function<void(std::int32_t i, std::int32_t j, const Eigen::Vector3d& r)>& visit);

struct NearGrain {
  std::int32_t index;          ///< in the sites
  double distance;             ///< [d]
  Eigen::Vector3d separation;  ///< from the grain to its neighbour's nearest image [d]
};

/// The neighbours of each of several sites, nearest first; equal distances by index.
class NearGrains {
 public:
  /// Of the first `count` sites, among all sites within `reach` [d]; as for_each_pair().
  NearGrains(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites,
             std::size_t count, double reach);

  std::span<const NearGrain> of(std::size_t grain) const {
    return {near_.data() + first_[grain], first_[grain + 1] - first_[grain]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<NearGrain> near_;
};

}  // namespace shearcell
