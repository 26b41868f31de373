// SPDX-License-Identifier: GPL-3.0-or-later
// Grains and wall grains copied into the order of a grid's cells, so that a search reads contiguous
// memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/kernel.hpp"
#include "core/team.hpp"

namespace shearcell {

/// Places [begin, end) of consecutive cells.
struct PlaceRun {
  std::size_t begin, end;
};

/// The place among all lines of cells along x of the line at `row` and `layer`.
inline std::int32_t line_of(const CellGrid& grid, std::int32_t row, std::int32_t layer) {
  const std::int32_t first = layer - layer % grid.strip;
  return first * grid.rows + row * std::min(grid.strip, grid.layers - first) + layer - first;
}

/// The places in the cell of the site at `place` and in its neighbours, each once: at most nine
/// runs of three neighbouring cells in x. Returns their number.
inline std::size_t surrounding_runs(const CellGrid& grid, std::size_t place,
                                    std::array<PlaceRun, 9>& runs) {
  const auto cell = static_cast<std::int32_t>(grid.cell[place]);
  const std::int32_t column = cell % grid.columns;
  const std::int32_t line = cell / grid.columns;
  const std::int32_t strip = line / (grid.strip * grid.rows) * grid.strip;  // its first layer
  const std::int32_t width = std::min(grid.strip, grid.layers - strip);
  const std::int32_t row = (line - strip * grid.rows) / width;
  const std::int32_t layer = strip + (line - strip * grid.rows) % width;
  const std::int32_t first = column > 0 ? column - 1 : 0;
  const std::int32_t last = column + 1 < grid.columns ? column + 1 : column;
  // With fewer than three layers the neighbours on both sides coincide.
  const std::int32_t layers = grid.layers < 3 ? grid.layers : 3;
  std::size_t count = 0;
  for (std::int32_t r = row > 0 ? row - 1 : 0; r <= row + 1 && r < grid.rows; ++r) {
    for (std::int32_t k = 0; k < layers; ++k) {
      const std::int32_t z = grid.layers < 3 ? k : (layer + k - 1 + grid.layers) % grid.layers;
      const std::int32_t begin = line_of(grid, r, z) * grid.columns;
      runs[count++] = {grid.begin[begin + first], grid.begin[begin + last + 1]};
    }
  }
  return count;
}

/// Row offset and permanent id of a grain or a wall grain.
struct Site {
  std::int32_t offset, id;
};

/// A grid in the untilted frame. Its cells are at least as wide as the reach in x, y and z; sites
/// outside the walls belong to the border cells.
class CellOrder {
 public:
  /// Sorts sites (kernel.hpp's rows) into cells for pairs up to `reach` [d] apart.
  void build(const Cell& cell, const WallPose& pose, double reach, const double* rows,
             const std::vector<Site>& sites, Team& team);

  const CellGrid& grid() const { return grid_; }
  std::size_t size() const { return site_.size(); }
  /// About how many places after a site its farthest neighbours are, a multiple of 8; 0 in a cell
  /// that fits in a core's cache.
  std::size_t ahead() const { return ahead_; }
  /// Index in the given sites of the site at each place.
  const std::vector<std::int32_t>& site() const { return site_; }
  std::size_t bytes() const;

 private:
  void choose_grid(const Cell& cell, const WallPose& pose, double reach, std::size_t sites);
  void choose_strip(std::size_t sites);
  std::uint32_t cell_of(const double* row, const Cell& cell, const WallPose& pose) const;

  CellGrid grid_;
  std::size_t ahead_ = 0;
  std::array<double, 3> per_cell_{};  // cells per d in x, y, z
  std::vector<std::uint32_t> begin_, cell_, cell_of_site_;
  std::array<AlignedVector<double>, 4> row_;  // x, y, z, margin
  AlignedVector<std::int32_t> id_;
  std::vector<std::int32_t> site_;
};

}  // namespace shearcell
