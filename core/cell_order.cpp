// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/cell_order.hpp"

#include <algorithm>
#include <cmath>

namespace shearcell {

// The kernel visits the sites row by row. Most neighbours of a site lie in its own row of cells and
// in the rows below and above. Narrow strips (grid.hpp) make the rows short, so that three rows fit
// in the cache.
void CellOrder::choose_strip(std::size_t sites) {
  Grid& cells = grid_.cells;
  constexpr double kSitesPerRow = 1200;
  const double line = static_cast<double>(sites) / (1.0 * cells.rows * cells.layers);
  const double strip = std::min(std::max(kSitesPerRow / line, 3.0), 1.0 * cells.layers);
  cells.strip = static_cast<std::int32_t>(strip);
  // A row consists of `strip` lines of cells, and each line is parallel to x. The prefetch distance
  // is the average number of sites in `strip` + 2 lines, times 1.2 because some rows have more
  // sites. With fewer than kSmall sites, all sites fit in the cache, so nothing is prefetched.
  constexpr std::size_t kSmall = 4000;
  const double ahead = sites < kSmall ? 0 : 1.2 * line * (cells.strip + 2);
  ahead_ = padded(static_cast<std::size_t>(ahead));
}

void CellOrder::build(const Cell& cell, const WallPose& pose, double reach, const double* rows,
                      const std::vector<Site>& sites, Team& team) {
  // In the untilted frame, two points at distance r differ by up to r sqrt(1 + tan^2(theta)) in x.
  const double reach_x = reach * std::sqrt(1 + pose.tan_theta * pose.tan_theta);
  grid_.cells = Grid(cell, pose, {reach_x, reach, reach}, sites.size());
  choose_strip(sites.size());
  const std::size_t cells = grid_.cells.size();
  begin_.assign(cells + 1, 0);
  cell_of_site_.resize(sites.size());
  team.run(sites.size(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) {
      cell_of_site_[s] = grid_.cells.cell_of(rows + sites[s].offset);
    }
  });
  for (const std::uint32_t c : cell_of_site_) ++begin_[c + 1];
  for (std::size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];

  site_.resize(sites.size());
  id_.assign(padded(sites.size()) + 8, 0);  // vector loads may read past the last site
  for (auto& axis : row_) axis.resize(padded(sites.size()) + 8);
  std::vector<std::uint32_t>& next = cell_;  // scratch memory until cell_ is filled
  next.assign(begin_.begin(), begin_.end());
  for (std::size_t s = 0; s < sites.size(); ++s) {
    site_[next[cell_of_site_[s]]++] = static_cast<std::int32_t>(s);
  }
  cell_.resize(sites.size());
  team.run(sites.size(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t place = first; place < last; ++place) {
      const auto s = static_cast<std::size_t>(site_[place]);
      cell_[place] = cell_of_site_[s];
      id_[place] = sites[s].id;
      for (std::size_t k = 0; k < 4; ++k) {
        row_[k][place] = rows[static_cast<std::size_t>(sites[s].offset) + k];
      }
    }
  });
  grid_.begin = begin_.data();
  grid_.cell = cell_.data();
  grid_.id = id_.data();
  for (std::size_t axis = 0; axis < 3; ++axis) grid_.position[axis] = row_[axis].data();
  grid_.margin = row_[3].data();
}

std::size_t CellOrder::bytes() const {
  return 4 * (begin_.size() + cell_.size() + cell_of_site_.size() + id_.size() + site_.size()) +
         4 * sizeof(double) * row_[0].size();
}

}  // namespace shearcell
