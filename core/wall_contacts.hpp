// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of grains with the wall planes and the wall grains, looked for only near the walls.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/kernel.hpp"

namespace shearcell {

class WallContacts {
 public:
  WallContacts(const Kernels& kernels, const Cell& cell);

  /// Finds, for each wall, the grains that may touch it while the outer list is valid, and the wall
  /// grains within `cutoff` [d] of each. `id` is the permanent id of each grain in memory.
  void build(const double* rows, std::size_t grains, const std::vector<std::int32_t>& id,
             const WallPose& pose, double cutoff);

  /// Sets the wall sums (StepTask::wall_sum) of all grains near a wall, and returns the sum of the
  /// y components over the contacts with the moving wall, in ascending permanent id [d].
  double evaluate(const double* rows, const WallPose& pose,
                  std::array<AlignedVector<double>, 3>& wall_sum);

  std::size_t bytes() const;

 private:
  struct Side {
    std::array<double, 2> point, normal;
    std::vector<std::size_t> grains;      // its wall grains, as positions in cell.wall_grains
    AlignedVector<double> rows;           // their centres, and one that nothing touches
    AlignedVector<std::int32_t> members;  // offsets of the grains near this wall
    std::size_t count = 0;                // members without padding
    AlignedVector<std::int32_t> list;
    std::vector<std::uint16_t> slots;
    std::size_t stride = 8;
    std::vector<double> push;
  };

  void place(const WallPose& pose);
  void find_neighbours(Side& side, const double* rows, double cutoff, const WallPose& pose);

  const Kernels& kernels_;
  Cell cell_;
  std::array<Side, 4> sides_;
};

}  // namespace shearcell
