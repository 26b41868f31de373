// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/linked_cells.hpp"

#include <algorithm>
#include <cmath>

namespace shearcell {
CellCounts count_cells(std::array<double, 3> lengths, std::array<double, 3> sizes,
                       std::size_t points) {
  const double most = 64 + 4 * static_cast<double>(points);
  for (;;) {
    std::array<double, 3> counts{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      counts[axis] = std::max(1.0, std::min(std::floor(lengths[axis] / sizes[axis]), 1e9));
      sizes[axis] *= 1.26;
    }
    if (counts[0] * counts[1] * counts[2] > most) continue;
    return {static_cast<std::int32_t>(counts[0]), static_cast<std::int32_t>(counts[1]),
            static_cast<std::int32_t>(counts[2])};
  }
}

LinkedCells::LinkedCells(double width, double low, double high, double depth, double reach,
                         std::size_t points)
    : low_(low), depth_(depth) {
  const CellCounts cells = count_cells({width, high - low, depth}, {reach, reach, reach}, points);
  nx_ = cells.x;
  ny_ = cells.y;
  nz_ = cells.z;
  per_x_ = nx_ / width;
  per_y_ = ny_ / (high - low);
  per_z_ = nz_ / depth;
  head_.assign(index(0, ny_, 0), -1);
}

int LinkedCells::column(double x) const {
  return clamp_to_cell(x * per_x_, nx_);
}
int LinkedCells::row(double y) const {
  return clamp_to_cell((y - low_) * per_y_, ny_);
}
int LinkedCells::layer(double z) const {
  return clamp_to_cell(wrapped(z, depth_) * per_z_, nz_);
}

void LinkedCells::insert(std::int32_t point, double x, double y, double z) {
  const auto slot = static_cast<std::size_t>(point);
  if (next_.size() <= slot) next_.resize(std::max(slot + 1, 2 * next_.size()), -1);
  std::int32_t& head = head_[index(column(x), row(y), layer(z))];
  next_[slot] = head;
  head = point;
}

}  // namespace shearcell
