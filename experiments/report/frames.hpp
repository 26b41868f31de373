// SPDX-License-Identifier: GPL-3.0-or-later
// One checkpoint packed for a picture: positions and measures of each grain in 16 bits.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "analysis/measures.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// `bytes` holds little-endian 16-bit words unless said otherwise, one array after the other, for N
/// grains and M wall grains:
///
///     x, y, z       N + M each: coordinate = origin + step * word [d]; z within the period
///     phi_local     N: word / 65535
///     q6            N: word / 65535
///     crystallite   N: its number from 1 on, 0 for none; 65535 for all beyond
///     structure     N bytes: 0 disordered, 1 FCC, 2 HCP; 4 is added for interior grains
struct PackedFrame {
  Eigen::Vector3d origin;
  Eigen::Vector3d step;  ///< a coordinate is off by no more than half of it [d]
  std::vector<std::byte> bytes;
};

PackedFrame pack_frame(const Checkpoint& checkpoint, const WallPose& pose,
                       const GrainMeasures& grains);

/// Bytes of a packed frame in the page, where they are written in base64.
std::size_t frame_size_in_page(std::size_t grains, std::size_t wall_grains);

}  // namespace shearcell
