// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/crystal.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace shearcell {
namespace {

/// Disjoint sets of grains; the lowest id of a set stands for it.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    const std::size_t ra = find(a);
    const std::size_t rb = find(b);
    parent_[std::max(ra, rb)] = std::min(ra, rb);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

Structure structure(double phi_local, double q6) {
  if (!(phi_local > crystalline_phi_local)) return Structure::disordered;
  if (std::abs(q6 - q6_fcc) < q6_tolerance) return Structure::fcc;
  if (std::abs(q6 - q6_hcp) < q6_tolerance) return Structure::hcp;
  return Structure::disordered;
}

Crystallites crystallites(const VoronoiDiagram& diagram, std::span<const std::uint8_t> crystalline,
                          double mean_surface) {
  const std::size_t count = crystalline.size();
  const double least = connecting_face * mean_surface;
  DisjointSets sets(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (crystalline[i] == 0) continue;
    for (const VoronoiFace& face : diagram.faces_of(i)) {
      if (face.kind != NeighbourKind::grain || face.area < least) continue;
      const auto j = static_cast<std::size_t>(face.neighbour);
      if (crystalline[j] != 0) sets.join(i, j);
    }
  }
  Crystallites result;
  result.label.assign(count, -1);
  for (std::size_t i = 0; i < count; ++i) {
    if (crystalline[i] == 0) continue;
    const std::size_t root = sets.find(i);  // root <= i, so it has its label already
    if (root == i) {
      result.label[i] = static_cast<std::int32_t>(result.size.size());
      result.size.push_back(0);
    } else {
      result.label[i] = result.label[root];
    }
    ++result.size[static_cast<std::size_t>(result.label[i])];
  }
  if (!result.size.empty())
    result.largest = *std::max_element(result.size.begin(), result.size.end());
  return result;
}

}  // namespace shearcell
