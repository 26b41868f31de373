// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/crystal.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <utility>

#include "analysis/measures.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

// (4 pi / 13) times the square of the normalization factor of Y_6m, for m = 0..6. Orders m and -m
// give equal squares, so the numbers for m > 0 include a factor of 2.
constexpr std::array<double, 7> order_weight = {
    1.0 / 256,        2 * 42.0 / 256,    2 * 420.0 / 4096, 2 * 420.0 / 1024,
    2 * 126.0 / 1024, 2 * 2772.0 / 1024, 2 * 924.0 / 4096};

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "stored maps are little-endian");

json packed(const std::vector<std::int32_t>& values) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
  return json::binary(std::vector(bytes, bytes + 4 * values.size()));
}

constexpr const char* invalid_map = "the stored map of crystallites is invalid";

std::vector<std::int32_t> unpacked(const json& result, const char* key) {
  const auto& bytes = result.at(key).get_binary();
  if (bytes.size() % 4 != 0) throw AnalysisError(invalid_map);
  std::vector<std::int32_t> values(bytes.size() / 4);
  std::ranges::copy(bytes, reinterpret_cast<std::uint8_t*>(values.data()));
  return values;
}

/// Whether grain ids ascend, labels are indices into `size`, each size is at least 1 and equals the
/// number of grains with this label, and centres and the cell are finite.
bool is_valid(const CrystalliteMap& map) {
  if (map.label.size() != map.grain.size() || map.centre.size() != map.size.size()) return false;
  if (!map.grain.empty() && map.grain.front() < 0) return false;
  if (std::ranges::adjacent_find(map.grain, std::greater_equal()) != map.grain.end()) return false;
  std::vector<std::int32_t> count(map.size.size());
  for (const std::int32_t label : map.label) {
    if (label < 0 || static_cast<std::size_t>(label) >= count.size()) return false;
    ++count[static_cast<std::size_t>(label)];
  }
  return count == map.size && std::ranges::count(count, 0) == 0 &&
         std::ranges::all_of(map.centre, [](const auto& c) { return c.allFinite(); }) &&
         std::isfinite(map.width) && map.width > 0 && std::isfinite(map.top - map.bottom) &&
         map.top > map.bottom;
}

/// Writes arrays of integers as little-endian bytes. Writes real numbers as JSON numbers.
json packed_map(const MeasureInput& input) {
  const CrystalliteMap& map = input.analysis->crystallites;
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

/// Reads the result of packed_map(). Throws AnalysisError unless the map is_valid().
void read_map(const json& result, Measures& measures) {
  CrystalliteMap map;
  map.grain = unpacked(result, "grain");
  map.label = unpacked(result, "label");
  map.size = unpacked(result, "size");
  for (const auto& [x, y, z] : result.at("centre_d").get<std::vector<std::array<double, 3>>>()) {
    map.centre.emplace_back(x, y, z);
  }
  result.at("width_d").get_to(map.width);
  result.at("bottom_d").get_to(map.bottom);
  result.at("top_d").get_to(map.top);
  if (!is_valid(map)) throw AnalysisError(invalid_map);
  measures.crystallite_map = std::move(map);
}

}  // namespace

double bond_order_q6(std::span<const VoronoiFace> faces, double surface) {
  // sums[m]: weight * Y_6m(x, y, z) / C, summed over the bonds. C is the coefficient of Y_6m:
  // Y_6m / C is (x + iy)^m times a polynomial in z.
  std::array<std::complex<double>, 7> sums{};
  for (const VoronoiFace& face : faces) {
    if (face.kind == NeighbourKind::wall_plane) continue;
    const Eigen::Vector3d bond = face.to_neighbour / face.to_neighbour.norm();
    const double z = bond.z(), z2 = z * z;
    const std::array<double, 7> polynomial = {((231 * z2 - 315) * z2 + 105) * z2 - 5,
                                              z * ((33 * z2 - 30) * z2 + 5),
                                              (33 * z2 - 18) * z2 + 1,
                                              z * (11 * z2 - 3),
                                              11 * z2 - 1,
                                              z,
                                              1};
    const std::complex<double> in_plane(bond.x(), bond.y());
    std::complex<double> power = 1;
    for (std::size_t m = 0; m < sums.size(); ++m) {
      sums[m] += face.area / surface * polynomial[m] * power;
      power *= in_plane;
    }
  }
  double square = 0;
  for (std::size_t m = 0; m < sums.size(); ++m) square += order_weight[m] * std::norm(sums[m]);
  return std::sqrt(square);
}

Structure structure(double phi_local, double q6, double least_phi_local, double tolerance) {
  if (!(phi_local > least_phi_local)) return Structure::disordered;
  if (std::abs(q6 - q6_fcc) < tolerance) return Structure::fcc;
  if (std::abs(q6 - q6_hcp) < tolerance) return Structure::hcp;
  return Structure::disordered;
}

std::vector<std::int32_t> crystallites(const VoronoiDiagram& diagram,
                                       std::span<const std::uint8_t> crystalline,
                                       double least_face) {
  const std::size_t count = crystalline.size();
  boost::disjoint_sets_with_storage<> sets(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (crystalline[i] == 0) continue;
    for (const VoronoiFace& face : diagram.faces_of(i)) {
      if (face.kind != NeighbourKind::grain || face.area < least_face) continue;
      const auto j = static_cast<std::size_t>(face.neighbour);
      if (crystalline[j] != 0) sets.union_set(i, j);
    }
  }
  std::int32_t found = 0;
  std::vector<std::int32_t> labels(count, -1);
  std::vector<std::int32_t> label_of(count, -1);  // label of a set, stored at its representative
  for (std::size_t i = 0; i < count; ++i) {
    if (crystalline[i] == 0) continue;
    std::int32_t& label = label_of[sets.find_set(i)];
    if (label < 0) label = found++;
    labels[i] = label;
  }
  return labels;
}

CrystalliteMap crystallite_map(std::span<const std::int32_t> crystallite, const Cell& cell,
                               const WallPose& pose, const Eigen::Matrix3Xd& positions) {
  CrystalliteMap map{.width = cell.width, .bottom = pose.bottom, .top = pose.top};
  struct Sums {
    Eigen::Vector2d place = {0, 0}, phase = {0, 0};
  };
  std::vector<Sums> sums;
  const double turn = 2 * std::numbers::pi / cell.depth;
  for (std::size_t i = 0; i < crystallite.size(); ++i) {
    if (crystallite[i] < 0) continue;
    const auto label = static_cast<std::size_t>(crystallite[i]);
    map.grain.push_back(static_cast<std::int32_t>(i));
    map.label.push_back(crystallite[i]);
    if (label == sums.size()) {
      sums.emplace_back();
      map.size.push_back(0);
    }
    ++map.size[label];
    const Eigen::Vector3d r = positions.col(static_cast<Eigen::Index>(i));
    sums[label].place += Eigen::Vector2d(r.x() - (r.y() - pose.top) * pose.tan_theta, r.y());
    sums[label].phase += Eigen::Vector2d(std::cos(turn * r.z()), std::sin(turn * r.z()));
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    const Eigen::Vector2d mean = sums[c].place / map.size[c];
    const double z = std::atan2(sums[c].phase.y(), sums[c].phase.x()) / turn;
    map.centre.emplace_back(mean.x(), mean.y(), z < 0 ? z + cell.depth : z);
  }
  return map;
}

std::vector<Provider> crystallite_providers() {
  return {{.name = "crystallites",
           .parameters = crystal_criteria(),
           .compute = packed_map,
           .read_more = read_map}};
}

}  // namespace shearcell
