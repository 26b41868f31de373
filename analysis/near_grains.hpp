// SPDX-License-Identifier: GPL-3.0-or-later
// Grains near grains, whether they touch or not.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "core/cell.hpp"

namespace shearcell {

/// Calls visit(i, j, r) for every pair i < j of `sites` (3 x n [d], z unwrapped) that are at most
/// `reach` [d] apart, with r from j's nearest image to i. `reach` must not exceed half the depth
/// of the cell, beyond which images would be missed.
void for_each_pair(
    const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites, double reach,
    const std::function<void(std::int32_t i, std::int32_t j, const Eigen::Vector3d& r)>& visit);

}  // namespace shearcell
