// SPDX-License-Identifier: GPL-3.0-or-later
// Copies of grains and wall grains, sorted by grid cell, so that a neighbour search reads
// contiguous memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/kernel.hpp"
#include "core/team.hpp"

namespace shearcell {

/// A grain or a wall grain: the offset of its row (kernel.hpp) and its permanent id.
struct Site {
  std::int32_t offset, id;
};

class CellOrder {
 public:
  /// Sorts the sites into grid cells. `rows` holds the positions of the sites (kernel.hpp). Sites
  /// up to `reach` [d] apart lie in the same grid cell or in neighbouring grid cells.
  void build(const Cell& cell, const WallPose& pose, double reach, const double* rows,
             const std::vector<Site>& sites, Team& team);

  const CellGrid& grid() const { return grid_; }
  std::size_t size() const { return site_.size(); }
  /// In the sorted order, the last neighbour of a site is about this many sites after it. A
  /// multiple of 8; 0 if all sites fit in the cache of a core.
  std::size_t ahead() const { return ahead_; }
  /// Index of each sorted site in the unsorted list of sites that build() received.
  const std::vector<std::int32_t>& site() const { return site_; }
  std::size_t bytes() const;

 private:
  void choose_strip(std::size_t sites);

  CellGrid grid_;
  std::size_t ahead_ = 0;
  std::vector<std::uint32_t> begin_, cell_, cell_of_site_;
  std::array<AlignedVector<double>, 4> row_;  // x, y, z, margin
  AlignedVector<std::int32_t> id_;
  std::vector<std::int32_t> site_;
};

}  // namespace shearcell
