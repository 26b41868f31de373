// SPDX-License-Identifier: GPL-3.0-or-later
// One checkpoint packed for a picture: positions and measures of each grain in 16 bits.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
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
///     each field    N bytes, see GrainField
struct PackedFrame {
  Eigen::Vector3d origin;
  Eigen::Vector3d step;  ///< a coordinate is off by no more than half of it [d]
  std::vector<std::byte> bytes;
};

/// A further measure of each grain, by which a packing can be coloured. A byte is a class, or
/// 254 (value - low) / (high - low), of logarithms where `logarithmic`; 255 where it is unknown.
struct GrainField {
  std::string key;
  std::string unit = {};
  double low = 0, high = 0;
  bool logarithmic = false;
  std::vector<std::string> classes = {};  ///< names of classes 0, 1, ...; none for a quantity
  std::vector<double> value;              ///< of each grain
};

/// {"key", "unit", "low", "high", "log"} or {"key", "classes"}.
nlohmann::json to_json(const GrainField& field);

PackedFrame pack_frame(const Checkpoint& checkpoint, const WallPose& pose,
                       const GrainMeasures& grains, std::span<const GrainField> fields = {});

/// Bytes of a packed frame in the page, where they are written in base64.
std::size_t frame_size_in_page(std::size_t grains, std::size_t wall_grains, std::size_t fields);

}  // namespace shearcell
