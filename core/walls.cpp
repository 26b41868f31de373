// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/walls.hpp"

#include <algorithm>

namespace shearcell {

Walls::Walls(const Cell& cell) : cell_(cell) {
  std::vector<WallGrain>& grains = cell_.wall_grains;
  const auto moves = [&](const WallGrain& grain) { return grain.side == moving_side(cell_); };
  const auto others = std::stable_partition(grains.begin(), grains.end(), moves);
  moving_size_ = static_cast<std::size_t>(others - grains.begin());
}

std::array<WallPlane, 4> Walls::planes(const WallPose& pose) const {
  std::array<WallPlane, 4> planes = wall_planes(cell_, pose);
  const auto moving = static_cast<std::ptrdiff_t>(moving_side(cell_));
  std::rotate(planes.begin(), planes.begin() + moving, planes.begin() + moving + 1);
  return planes;
}

void Walls::place_all(const WallPose& pose, double margin, double* rows) const {
  for (const WallGrain& grain : cell_.wall_grains) {
    Eigen::Map<Eigen::Vector3d>{rows} = wall_grain_position(cell_, pose, grain);
    rows[3] = margin;
    rows += 4;
  }
}

void Walls::choose_active(const WallPose& pose, double reach) {
  active_.clear();
  for (std::size_t w = 0; w < cell_.wall_grains.size(); ++w) {
    const double y = wall_grain_position(cell_, pose, cell_.wall_grains[w]).y();
    if (y > pose.bottom - reach && y < pose.top + reach) {
      active_.push_back(static_cast<std::int32_t>(w));
    }
  }
}

// Uses the operations of wall_grain_position() in the same order, so both give the same bits.
void Walls::place(const WallPose& pose, double* rows, Team& team) const {
  const double bottom_x = (pose.bottom - pose.top) * pose.tan_theta;
  const double bottom_y = pose.bottom - cell_.bottom;
  const double top_y = pose.top - cell_.top;
  team.run(active_.size(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto w = static_cast<std::size_t>(active_[k]);
      const auto& [side, p] = cell_.wall_grains[w];
      double* row = rows + 4 * w;
      if (side == WallSide::bottom) {
        row[0] = p.x() + bottom_x;
        row[1] = p.y() + bottom_y;
      } else if (side == WallSide::top) {
        row[1] = p.y() + top_y;
      } else {
        row[0] = p.x() + (p.y() - pose.top) * pose.tan_theta;
      }
    }
  });
}

}  // namespace shearcell
