// SPDX-License-Identifier: GPL-3.0-or-later
// The walls as the kernel sees them: four planes, and wall grains as rows behind those of the
// grains.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cell.hpp"
#include "core/kernel.hpp"

namespace shearcell {

/// Where planes and wall grains are in a pose. Wall grains are numbered with those of the moving
/// wall first and otherwise in the order of the cell; that is their permanent id.
class Walls {
 public:
  explicit Walls(const Cell& cell);

  std::size_t size() const { return grains_.size(); }
  /// How many wall grains belong to the moving wall; they come first.
  std::size_t moving_size() const { return moving_size_; }

  /// The planes, that of the moving wall first, then by WallSide.
  std::array<WallPlane, 4> planes(const WallPose& pose) const;

  /// Writes the centres of all wall grains [d], with this margin, into rows of 4.
  void place_all(const WallPose& pose, double margin, double* rows) const;

  /// From now on `place` moves only those that stand within `reach` [d] of the cell's height: side
  /// walls go on where the moving wall has left them behind.
  void choose_active(const WallPose& pose, double reach);
  const std::vector<std::int32_t>& active() const { return active_; }

  /// Moves the active ones that can move, in rows that place_all has filled.
  void place(const WallPose& pose, double* rows) const;

  std::size_t bytes() const { return 64 * grains_.size() + 4 * active_.size(); }

 private:
  Cell cell_;
  std::vector<WallGrain> grains_;
  std::size_t moving_size_ = 0;
  std::vector<std::int32_t> active_;
};

}  // namespace shearcell
