// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/grid.hpp"

#include <cmath>

namespace shearcell {
namespace {

// Grid index along one axis. The value is clamped first, because the conversion may overflow.
std::int32_t clamp_to_cell(double scaled, std::int32_t cells) {
  if (!(scaled > 0)) return 0;
  return static_cast<std::int32_t>(std::min(scaled, static_cast<double>(cells - 1)));
}

}  // namespace

Grid::Grid(const Cell& cell, const WallPose& in_pose, std::array<double, 3> sizes,
           std::size_t points)
    : depth(cell.depth), pose(in_pose) {
  const std::array lengths = {cell.width, pose.top - pose.bottom, cell.depth};
  const double most = 64 + 4 * static_cast<double>(points);
  std::array<double, 3> counts{};
  do {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      counts[axis] = std::max(1.0, std::min(std::floor(lengths[axis] / sizes[axis]), 1e9));
      sizes[axis] *= 1.26;
    }
  } while (counts[0] * counts[1] * counts[2] > most);
  columns = static_cast<std::int32_t>(counts[0]);
  rows = static_cast<std::int32_t>(counts[1]);
  strip = layers = static_cast<std::int32_t>(counts[2]);
  for (std::size_t axis = 0; axis < 3; ++axis) per_cell[axis] = counts[axis] / lengths[axis];
}

std::uint32_t Grid::cell_of(const double* point) const {
  const double x = point[0] - pose.tan_theta * (point[1] - pose.top);
  const double z = point[2] - depth * std::floor(point[2] / depth);
  const std::int32_t column = clamp_to_cell(x * per_cell[0], columns);
  const std::int32_t row = clamp_to_cell((point[1] - pose.bottom) * per_cell[1], rows);
  const std::int32_t layer = clamp_to_cell(z * per_cell[2], layers);
  return static_cast<std::uint32_t>(line_of(row, layer) * columns + column);
}

}  // namespace shearcell
