// SPDX-License-Identifier: GPL-3.0-or-later
// Points sorted into grid cells. Points can be added between searches.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "core/grid.hpp"

namespace shearcell {

class LinkedCells {
 public:
  /// Makes a grid for finding points up to `reach` [d] apart in a cell with this pose.
  LinkedCells(const Cell& cell, const WallPose& pose, double reach, std::size_t points) {
    const double size = reach * std::sqrt(1 + pose.tan_theta * pose.tan_theta);
    grid_ = Grid(cell, pose, {size, size, size}, points);
    head_.assign(grid_.size(), -1);
  }

  /// Adds point `index`. Within a grid cell, points that were added later are visited first.
  void insert(std::int32_t index, const Eigen::Vector3d& at) {
    const auto slot = static_cast<std::size_t>(index);
    if (next_.size() <= slot) next_.resize(std::max(slot + 1, 2 * next_.size()), -1);
    next_[slot] = std::exchange(head_[grid_.cell_of(at.data())], index);
  }

  /// Calls visit(index) once for every point in the grid cell of `at` and in the cells around it.
  template <class Visit>
  void for_each_near(const Eigen::Vector3d& at, Visit&& visit) const {
    std::array<CellRange, 9> ranges;
    const std::size_t count = grid_.surrounding(grid_.cell_of(at.data()), ranges);
    for (std::size_t r = 0; r < count; ++r) {
      for (std::size_t cell = ranges[r].begin; cell < ranges[r].end; ++cell) {
        for (std::int32_t p = head_[cell]; p >= 0; p = next_[static_cast<std::size_t>(p)]) visit(p);
      }
    }
  }

 private:
  Grid grid_;
  std::vector<std::int32_t> head_, next_;
};

}  // namespace shearcell
