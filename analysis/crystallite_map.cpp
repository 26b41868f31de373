// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/crystallite_map.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "analysis/error.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

json packed(const std::vector<std::int32_t>& values) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * values.size());
  for (const std::int32_t value : values) {
    const auto bits = static_cast<std::uint32_t>(value);
    for (unsigned shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  return json::binary(std::move(bytes));
}

[[noreturn]] void refuse(const std::string& why) {
  throw AnalysisError("these are not the crystallites of a checkpoint: " + why);
}

std::vector<std::int32_t> unpacked(const json& result, const char* key) {
  const auto& bytes = result.at(key).get_binary();
  if (bytes.size() % 4 != 0) refuse(std::string(key) + " has a broken number");
  std::vector<std::int32_t> values;
  for (std::size_t k = 0; k < bytes.size(); k += 4) {
    std::uint32_t bits = 0;
    for (unsigned b = 0; b < 4; ++b) bits |= static_cast<std::uint32_t>(bytes[k + b]) << (8 * b);
    values.push_back(static_cast<std::int32_t>(bits));
  }
  return values;
}

/// Ascending ids, each in a crystallite that exists, and as many in each as its size says.
void check(const CrystalliteMap& map) {
  if (map.label.size() != map.grain.size()) refuse("labels and grains differ in number");
  if (map.centre.size() != map.size.size()) refuse("centres and sizes differ in number");
  std::vector<std::int32_t> count(map.size.size());
  for (std::size_t k = 0; k < map.grain.size(); ++k) {
    const std::int32_t before = k == 0 ? -1 : map.grain[k - 1];
    if (map.grain[k] <= before) refuse("grains do not ascend");
    const auto label = static_cast<std::size_t>(map.label[k]);
    if (map.label[k] < 0 || label >= count.size()) refuse("a label without a crystallite");
    ++count[label];
  }
  if (count != map.size) refuse("sizes do not count the grains");
}

}  // namespace

CrystalliteMap crystallite_map(const Crystallites& crystallites, const Cell& cell,
                               const WallPose& pose, const Eigen::Matrix3Xd& positions) {
  CrystalliteMap map;
  map.size = crystallites.size;
  map.width = cell.width;
  map.bottom = pose.bottom;
  map.top = pose.top;
  const std::size_t count = map.size.size();
  std::vector<Eigen::Vector2d> sum(count, Eigen::Vector2d::Zero());
  std::vector<Eigen::Vector2d> phase(count, Eigen::Vector2d::Zero());
  const double turn = 2 * std::numbers::pi / cell.depth;
  for (std::size_t i = 0; i < crystallites.label.size(); ++i) {
    if (crystallites.label[i] < 0) continue;
    const auto label = static_cast<std::size_t>(crystallites.label[i]);
    const Eigen::Vector3d r = positions.col(static_cast<Eigen::Index>(i));
    map.grain.push_back(static_cast<std::int32_t>(i));
    map.label.push_back(crystallites.label[i]);
    sum[label] += Eigen::Vector2d(r.x() - (r.y() - pose.top) * pose.tan_theta, r.y());
    phase[label] += Eigen::Vector2d(std::cos(turn * r.z()), std::sin(turn * r.z()));
  }
  for (std::size_t c = 0; c < count; ++c) {
    const Eigen::Vector2d mean = sum[c] / map.size[c];
    const double z = std::atan2(phase[c].y(), phase[c].x()) / turn;
    map.centre.emplace_back(mean.x(), mean.y(), z < 0 ? z + cell.depth : z);
  }
  return map;
}

json to_json(const CrystalliteMap& map) {
  json centres = json::array();
  for (const Eigen::Vector3d& c : map.centre) centres.push_back({c.x(), c.y(), c.z()});
  return {{"grain", packed(map.grain)},
          {"label", packed(map.label)},
          {"size", packed(map.size)},
          {"centre_d", centres},
          {"width_d", map.width},
          {"bottom_d", map.bottom},
          {"top_d", map.top}};
}

CrystalliteMap read_crystallite_map(const json& result) {
  CrystalliteMap map;
  try {
    map.grain = unpacked(result, "grain");
    map.label = unpacked(result, "label");
    map.size = unpacked(result, "size");
    for (const json& c : result.at("centre_d")) {
      map.centre.emplace_back(c.at(0).get<double>(), c.at(1).get<double>(), c.at(2).get<double>());
    }
    result.at("width_d").get_to(map.width);
    result.at("bottom_d").get_to(map.bottom);
    result.at("top_d").get_to(map.top);
  } catch (const json::exception& problem) {
    refuse(problem.what());
  }
  check(map);
  return map;
}

}  // namespace shearcell
