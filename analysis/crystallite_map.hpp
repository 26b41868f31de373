// SPDX-License-Identifier: GPL-3.0-or-later
// The crystallites of one checkpoint, their places and their grains, in a form that can be stored,
// for tracking.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "analysis/crystal.hpp"
#include "core/cell.hpp"

namespace shearcell {

struct CrystalliteMap {
  std::vector<std::int32_t> grain;      ///< ids of the crystalline interior grains, ascending
  std::vector<std::int32_t> label;      ///< crystallite of each of them
  std::vector<std::int32_t> size;       ///< grains in each crystallite
  std::vector<Eigen::Vector3d> centre;  ///< of mass of each crystallite [d]; see crystallite_map()
  double width = 0;                     ///< of the cell [d]
  double bottom = 0;                    ///< heights of the horizontal planes [d]
  double top = 0;
};

/// Centres are in the untilted cell: x is less the displacement of the walls at that height, so
/// that 0 <= x <= width. z is a mean of angles over the period, in [0, depth): exact for what is
/// small beside the period.
CrystalliteMap crystallite_map(const Crystallites& crystallites, const Cell& cell,
                               const WallPose& pose, const Eigen::Matrix3Xd& positions);

/// Arrays as little-endian bytes, reals as JSON numbers.
nlohmann::json to_json(const CrystalliteMap& map);

/// The inverse. The JSON is not trusted: throws AnalysisError when arrays do not fit together.
CrystalliteMap read_crystallite_map(const nlohmann::json& result);

}  // namespace shearcell
