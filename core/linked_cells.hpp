// SPDX-License-Identifier: GPL-3.0-or-later
// Points in a grid of cells at least as wide as a search distance, so that all near points lie in
// 27 cells. Used where points are still being added and speed matters little.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shearcell {

/// The cell of a scaled coordinate. Clamped in floating point, so that a wild coordinate (or NaN)
/// belongs to a border cell.
inline std::int32_t clamp_to_cell(double scaled, std::int32_t cells) {
  if (!(scaled > 0)) return 0;
  return static_cast<std::int32_t>(std::min(scaled, static_cast<double>(cells - 1)));
}

/// Numbers of cells along x, y and z.
struct CellCounts {
  std::int32_t x, y, z;
};

/// As many cells of at least these sizes as fit into the lengths [d], of which there are at most
/// about four per point, so that a nearly empty box costs no more than its points: it has larger
/// cells.
CellCounts count_cells(std::array<double, 3> lengths, std::array<double, 3> sizes,
                       std::size_t points);

/// The image of z in [0, depth).
inline double wrapped(double z, double depth) {
  return z - depth * std::floor(z / depth);
}

/// A grid over [0, width] x [low, high] x [0, depth), periodic in z. Points outside in x or y
/// belong to the border cells, which is correct up to a distance of one cell.
class LinkedCells {
 public:
  /// Cells are at least `reach` [d] wide.
  LinkedCells(double width, double low, double high, double depth, double reach,
              std::size_t points);

  /// Adds point `index`; a later point of a cell is visited before an earlier one.
  void insert(std::int32_t index, double x, double y, double z);

  /// Calls visit(index) for every point in the cell of (x, y, z) and its neighbours, once each.
  template <class Visit>
  void for_each_near(double x, double y, double z, Visit&& visit) const {
    const int cx = column(x), cy = row(y), cz = layer(z);
    // With fewer than three layers the neighbours above and below coincide.
    const int layers = nz_ < 3 ? nz_ : 3;
    for (int iy = cy > 0 ? cy - 1 : 0; iy <= cy + 1 && iy < ny_; ++iy) {
      for (int k = 0; k < layers; ++k) {
        const int iz = nz_ < 3 ? k : (cz + k - 1 + nz_) % nz_;
        for (int ix = cx > 0 ? cx - 1 : 0; ix <= cx + 1 && ix < nx_; ++ix) {
          for (std::int32_t p = head_[index(ix, iy, iz)]; p >= 0;
               p = next_[static_cast<std::size_t>(p)]) {
            visit(p);
          }
        }
      }
    }
  }

 private:
  std::size_t index(int ix, int iy, int iz) const {
    return (static_cast<std::size_t>(iy) * static_cast<std::size_t>(nz_) +
            static_cast<std::size_t>(iz)) *
               static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(ix);
  }
  int column(double x) const;
  int row(double y) const;
  int layer(double z) const;

  double low_, depth_;
  double per_x_, per_y_, per_z_;
  int nx_, ny_, nz_;
  std::vector<std::int32_t> head_;
  std::vector<std::int32_t> next_;
};

}  // namespace shearcell
