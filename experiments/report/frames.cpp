// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "analysis/voronoi.hpp"

namespace shearcell {
namespace {

constexpr double largest_word = 65535;

void put_word(double value, std::vector<std::byte>& bytes) {
  const auto word = static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.0, largest_word)));
  bytes.push_back(static_cast<std::byte>(word & 0xFFU));
  bytes.push_back(static_cast<std::byte>(word >> 8U));
}

std::byte byte_of(const GrainField& field, double value) {
  constexpr double most = 254;
  constexpr auto unknown = std::byte{255};
  if (!field.classes.empty()) return static_cast<std::byte>(static_cast<unsigned>(value));
  double share = (value - field.low) / (field.high - field.low);
  if (field.logarithmic) share = std::log(value / field.low) / std::log(field.high / field.low);
  if (std::isnan(share)) return unknown;
  return static_cast<std::byte>(std::lround(most * std::clamp(share, 0.0, 1.0)));
}

}  // namespace

PackedFrame pack_frame(const Checkpoint& checkpoint, const WallPose& pose,
                       const GrainMeasures& grains, std::span<const GrainField> fields) {
  const Eigen::Matrix3Xd position = wrapped_sites(checkpoint.cell, pose, checkpoint.state.position);
  PackedFrame frame;
  frame.origin = position.rowwise().minCoeff();
  frame.step = (position.rowwise().maxCoeff() - frame.origin) / largest_word;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double step = frame.step[axis] > 0 ? frame.step[axis] : 1;
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
      put_word((position(axis, i) - frame.origin[axis]) / step, frame.bytes);
    }
  }
  for (const double phi : grains.phi_local) put_word(phi * largest_word, frame.bytes);
  for (const double q6 : grains.q6) put_word(q6 * largest_word, frame.bytes);
  for (const std::int32_t label : grains.crystallites.label) put_word(label + 1.0, frame.bytes);
  for (std::size_t i = 0; i < grains.structure.size(); ++i) {
    const unsigned interior = grains.interior[i] != 0 ? 4 : 0;
    frame.bytes.push_back(
        static_cast<std::byte>(static_cast<unsigned>(grains.structure[i]) + interior));
  }
  for (const GrainField& field : fields) {
    for (const double value : field.value) frame.bytes.push_back(byte_of(field, value));
  }
  return frame;
}

nlohmann::json to_json(const GrainField& field) {
  if (!field.classes.empty()) return {{"key", field.key}, {"classes", field.classes}};
  return {{"key", field.key},
          {"unit", field.unit},
          {"low", field.low},
          {"high", field.high},
          {"log", field.logarithmic}};
}

std::size_t frame_size_in_page(std::size_t grains, std::size_t wall_grains, std::size_t fields) {
  const std::size_t bytes = 6 * (grains + wall_grains) + (7 + fields) * grains;
  return (bytes + 2) / 3 * 4;
}

}  // namespace shearcell
