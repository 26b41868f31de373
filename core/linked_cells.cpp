// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/linked_cells.hpp"

#include <algorithm>
#include <cmath>

namespace shearcell {
LinkedCells::LinkedCells(double width, double low, double high, double depth, double reach,
                         std::size_t points)
    : low_(low), depth_(depth) {
  const double most = 64 + 4 * static_cast<double>(points);
  double size = reach;
  double cells = 0;
  const auto count = [&size](double length) {
    return std::max(1.0, std::min(std::floor(length / size), 1e9));
  };
  for (;; size *= 1.26) {
    cells = count(width) * count(high - low) * count(depth);
    if (cells <= most) break;
  }
  nx_ = static_cast<int>(count(width));
  ny_ = static_cast<int>(count(high - low));
  nz_ = static_cast<int>(count(depth));
  per_x_ = nx_ / width;
  per_y_ = ny_ / (high - low);
  per_z_ = nz_ / depth;
  head_.assign(static_cast<std::size_t>(cells), -1);
}

int LinkedCells::column(double x) const {
  return clamp_to_cell(x * per_x_, nx_);
}
int LinkedCells::row(double y) const {
  return clamp_to_cell((y - low_) * per_y_, ny_);
}
int LinkedCells::layer(double z) const {
  return clamp_to_cell((z - depth_ * std::floor(z / depth_)) * per_z_, nz_);
}

void LinkedCells::insert(std::int32_t point, double x, double y, double z) {
  const auto slot = static_cast<std::size_t>(point);
  if (next_.size() <= slot) next_.resize(std::max(slot + 1, 2 * next_.size()), -1);
  std::int32_t& head = head_[index(column(x), row(y), layer(z))];
  next_[slot] = head;
  head = point;
}

}  // namespace shearcell
