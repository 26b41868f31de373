// SPDX-License-Identifier: GPL-3.0-or-later
// Grains and wall grains copied into the order of a grid's cells, so that a search reads contiguous
// memory.
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

/// Row offset and permanent id of a grain or a wall grain.
struct Site {
  std::int32_t offset, id;
};

class CellOrder {
 public:
  /// Sorts the sites, whose positions are in `rows` (kernel.hpp), into cells. Two sites at most
  /// `reach` [d] apart lie in the same cell or in neighbouring cells.
  void build(const Cell& cell, const WallPose& pose, double reach, const double* rows,
             const std::vector<Site>& sites, Team& team);

  const CellGrid& grid() const { return grid_; }
  std::size_t size() const { return site_.size(); }
  /// About how many places lie between a site and its farthest neighbours, a multiple of 8; 0 for a
  /// cell that fits in a core's cache.
  std::size_t ahead() const { return ahead_; }
  /// For each place the index of its site in the list that build() was given.
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
