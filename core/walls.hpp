// SPDX-License-Identifier: GPL-3.0-or-later
// The walls in the form that the kernel reads: four planes, and rows of the wall grains, which
// follow the rows of the grains.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cell.hpp"
#include "core/kernel.hpp"
#include "core/team.hpp"

namespace shearcell {

/// Wall planes and wall grains at a given pose of the walls. The grains of the moving wall have the
/// first permanent ids. The other wall grains follow in the order of Cell::wall_grains.
class Walls {
 public:
  explicit Walls(const Cell& cell);

  std::size_t size() const { return cell_.wall_grains.size(); }
  /// Number of grains of the moving wall, which have the smallest ids.
  std::size_t moving_size() const { return moving_size_; }

  /// The plane of the moving wall, then the other planes in the order of WallSide.
  std::array<WallPlane, 4> planes(const WallPose& pose) const;

  /// Writes a row {x, y, z, margin} [d] for each wall grain.
  void place_all(const WallPose& pose, double margin, double* rows) const;

  /// Selects the wall grains that place() updates: those between the bottom and the top plane, and
  /// those at most `reach` [d] outside these planes. (Side walls extend past the moving wall.)
  void choose_active(const WallPose& pose, double reach);
  const std::vector<std::int32_t>& active() const { return active_; }

  /// Updates the rows of the active wall grains. place_all() must have filled the rows before.
  void place(const WallPose& pose, double* rows, Team& team) const;

  std::size_t bytes() const { return sizeof(WallGrain) * size() + 4 * active_.size(); }

 private:
  Cell cell_;  // with the wall grains sorted by permanent id
  std::size_t moving_size_ = 0;
  std::vector<std::int32_t> active_;
};

}  // namespace shearcell
