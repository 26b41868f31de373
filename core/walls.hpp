// SPDX-License-Identifier: GPL-3.0-or-later
// The walls as the kernel sees them: four planes, and wall grains as rows after those of the
// grains.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cell.hpp"
#include "core/kernel.hpp"
#include "core/team.hpp"

namespace shearcell {

/// Planes and wall grains in a pose. The permanent id of a wall grain is its place in an order
/// where the grains of the moving wall come first and all others keep the order of the cell.
class Walls {
 public:
  explicit Walls(const Cell& cell);

  std::size_t size() const { return cell_.wall_grains.size(); }
  /// Number of wall grains of the moving wall; they come first.
  std::size_t moving_size() const { return moving_size_; }

  /// The plane of the moving wall, then the other planes by WallSide.
  std::array<WallPlane, 4> planes(const WallPose& pose) const;

  /// Writes the centres of all wall grains [d], with this margin, into rows of 4.
  void place_all(const WallPose& pose, double margin, double* rows) const;

  /// Selects the wall grains that `place` moves: the wall grains between the planes or up to
  /// `reach` [d] beyond them. Side walls extend beyond the moving wall.
  void choose_active(const WallPose& pose, double reach);
  const std::vector<std::int32_t>& active() const { return active_; }

  /// Updates the active wall grains in rows that place_all has filled.
  void place(const WallPose& pose, double* rows, Team& team) const;

  std::size_t bytes() const { return sizeof(WallGrain) * size() + 4 * active_.size(); }

 private:
  Cell cell_;  // its wall grains in the order of their permanent ids
  std::size_t moving_size_ = 0;
  std::vector<std::int32_t> active_;
};

}  // namespace shearcell
