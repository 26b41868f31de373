// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/packing_fraction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/site_grid.hpp"
#include "analysis/voronoi.hpp"

namespace shearcell {
namespace {

constexpr double sphere_volume = std::numbers::pi / 6;

double cube(double x) {
  return x * x * x;
}

}  // namespace

Overlaps overlaps(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains) {
  const SiteGrid grid(wrapped_sites(cell, pose, grains), cell.depth, 1.0);
  const auto count = static_cast<std::int32_t>(grains.cols());
  Overlaps result;
  result.largest.assign(static_cast<std::size_t>(count), 0.0);
  result.contacts.assign(static_cast<std::size_t>(count), 0);
  double sum = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    double largest = 0;
    std::int32_t contacts = 0;
    const auto touch = [&](std::int32_t j, const Eigen::Vector3d&, double distance2) {
      if (j == i) return;
      const double overlap = 1 - std::sqrt(distance2);
      largest = std::max(largest, overlap);
      ++contacts;
      if (j > i && j < count) {
        sum += overlap;
        ++result.pairs;
      }
    };
    grid.visit_within(grid.sites().col(i), 1, touch);
    result.largest[static_cast<std::size_t>(i)] = largest;
    result.contacts[static_cast<std::size_t>(i)] = contacts;
  }
  if (result.pairs > 0) result.mean = sum / static_cast<double>(result.pairs);
  return result;
}

std::vector<std::uint8_t> interior_grains(const Cell& cell, const WallPose& pose,
                                          const Eigen::Matrix3Xd& grains) {
  const double least = interior_distance + (cell.wall_grains.empty() ? 0.0 : rough_wall_surface);
  std::vector<std::uint8_t> interior(static_cast<std::size_t>(grains.cols()));
  for (Eigen::Index i = 0; i < grains.cols(); ++i) {
    const double distance = wall_distances(cell, pose, grains.col(i)).minCoeff();
    interior[static_cast<std::size_t>(i)] = distance >= least ? 1 : 0;
  }
  return interior;
}

double local_packing_fraction(double largest_overlap, double cell_volume) {
  return sphere_volume * cube(1 - largest_overlap) / cell_volume;
}

PackingFractions packing_fractions(std::span<const double> largest_overlap,
                                   std::span<const double> cell_volume,
                                   std::span<const std::uint8_t> selected) {
  double hard = 0;
  double soft = 0;
  double volume = 0;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    if (selected[i] == 0) continue;
    hard += sphere_volume * cube(1 - largest_overlap[i]);
    soft += sphere_volume;
    volume += cell_volume[i];
  }
  return {hard / volume, soft / volume};
}

}  // namespace shearcell
