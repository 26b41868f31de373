// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/packing_fraction.hpp"

#include <algorithm>
#include <numbers>

#include "analysis/voronoi.hpp"
#include "core/diagnostics.hpp"

namespace shearcell {
namespace {

constexpr double sphere_volume = std::numbers::pi / 6;

double cube(double x) {
  return x * x * x;
}

}  // namespace

Overlaps overlaps(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains) {
  Overlaps result;
  result.largest.assign(static_cast<std::size_t>(grains.cols()), 0.0);
  result.contacts.assign(static_cast<std::size_t>(grains.cols()), 0);
  const auto touch = [&](std::int32_t grain, double overlap) {
    double& largest = result.largest[static_cast<std::size_t>(grain)];
    largest = std::max(largest, overlap);
    ++result.contacts[static_cast<std::size_t>(grain)];
  };
  double sum = 0, pairs = 0;
  for_each_contact(cell, grains, pose, [&](const Contact& contact) {
    if (contact.kind == Contact::Kind::wall_plane) return;
    touch(contact.grain, contact.overlap);
    if (contact.kind == Contact::Kind::wall_grain) return;
    touch(contact.other, contact.overlap);
    sum += contact.overlap;
    ++pairs;
  });
  if (pairs > 0) result.mean = sum / pairs;
  return result;
}

std::vector<double> distances_from_walls(const Cell& cell, const WallPose& pose,
                                         const Eigen::Matrix3Xd& grains) {
  std::vector<double> found;
  for (const auto& centre : grains.colwise()) {
    found.push_back(wall_distances(cell, pose, centre).minCoeff() - wall_surface(cell));
  }
  return found;
}

std::vector<std::uint8_t> interior_grains(const Cell& cell, const WallPose& pose,
                                          const Eigen::Matrix3Xd& grains, double least) {
  std::vector<std::uint8_t> interior;
  for (const double distance : distances_from_walls(cell, pose, grains)) {
    interior.push_back(distance >= least ? 1 : 0);
  }
  return interior;
}

InteriorRegion interior_region(const Cell& cell, const WallPose& pose) {
  const double margin = interior_margin(cell);
  InteriorRegion region;
  region.tan_theta = pose.tan_theta;
  region.bottom = pose.bottom + margin;
  region.height = pose.top - pose.bottom - 2 * margin;
  region.depth = cell.depth;
  region.width = cell.width - 2 * margin / pose.cos_theta;
  region.left = (region.bottom - pose.top) * pose.tan_theta + margin / pose.cos_theta;
  return region;
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
