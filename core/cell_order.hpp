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
  /// Sorts sites (kernel.hpp's rows) into cells for pairs up to `reach` [d] apart.
  void build(const Cell& cell, const WallPose& pose, double reach, const double* rows,
             const std::vector<Site>& sites, Team& team);

  const CellGrid& grid() const { return grid_; }
  std::size_t size() const { return site_.size(); }
  /// Distance in places from a site to its farthest neighbours, roughly, as a multiple of 8; 0 in a
  /// cell that fits in a core's cache.
  std::size_t ahead() const { return ahead_; }
  /// Index in the given sites of the site at each place.
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
