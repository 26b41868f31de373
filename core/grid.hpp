// SPDX-License-Identifier: GPL-3.0-or-later
// A grid that divides the simulation cell into grid cells. A grid cell is at least as wide as the
// search distance. So all neighbours of a point lie in its grid cell or in the 26 cells around it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/cell.hpp"

namespace shearcell {

/// The grid cells with numbers from `begin` to `end` - 1.
struct CellRange {
  std::size_t begin, end;
};

/// A grid in the untilted frame of a pose, periodic in z. A point outside the walls belongs to a
/// border cell; a search finds it if it is at most one grid cell outside. The layers in z are
/// grouped into strips. In a strip, cell numbers increase fastest along x, then z, then y.
struct Grid {
  std::int32_t columns = 1, layers = 1, rows = 1;  ///< number of cells in x, z and y
  std::int32_t strip = 1;  ///< layers per strip; the last strip may have fewer
  double depth = 0;
  WallPose pose;
  std::array<double, 3> per_cell{};  ///< number of grid cells per d along x, y and z

  Grid() = default;
  /// Makes a grid with one strip. The grid cells are as small as possible, but not smaller than
  /// `sizes` [d]. To save memory, a grid has at most about four grid cells per point.
  Grid(const Cell& cell, const WallPose& in_pose, std::array<double, 3> sizes, std::size_t points);

  std::size_t size() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) *
           static_cast<std::size_t>(layers);
  }

  /// Number of the grid cell that holds {x, y, z}. A coordinate outside the grid, or NaN, is
  /// assigned to a border cell.
  std::uint32_t cell_of(const double* point) const;

  /// Index of the line of cells along x at `row` and `layer`.
  std::int32_t line_of(std::int32_t row, std::int32_t layer) const {
    const std::int32_t first = layer - layer % strip;
    return first * rows + row * std::min(strip, layers - first) + layer - first;
  }

  /// Lists a cell and its neighbours without duplicates, as at most nine ranges of up to three
  /// cells along x. Returns the number of ranges.
  std::size_t surrounding(std::uint32_t number, std::array<CellRange, 9>& ranges) const {
    const auto cell = static_cast<std::int32_t>(number);
    const std::int32_t column = cell % columns;
    const std::int32_t line = cell / columns;
    const std::int32_t start = line / (strip * rows) * strip;  // first layer of this strip
    const std::int32_t width = std::min(strip, layers - start);
    const std::int32_t row = (line - start * rows) / width;
    const std::int32_t layer = start + (line - start * rows) % width;
    const std::int32_t first = column > 0 ? column - 1 : 0;
    const std::int32_t last = column + 1 < columns ? column + 1 : column;
    // With fewer than three layers, the neighbours in +z and -z are the same cells.
    const std::int32_t most = layers < 3 ? layers : 3;
    std::size_t count = 0;
    for (std::int32_t r = row > 0 ? row - 1 : 0; r <= row + 1 && r < rows; ++r) {
      for (std::int32_t k = 0; k < most; ++k) {
        const std::int32_t z = layers < 3 ? k : (layer + k - 1 + layers) % layers;
        const std::int32_t begin = line_of(r, z) * columns;
        ranges[count++] = {static_cast<std::size_t>(begin + first),
                           static_cast<std::size_t>(begin + last + 1)};
      }
    }
    return count;
  }
};

}  // namespace shearcell
