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

/// Like the neighbour lists in two levels: for each wall, candidates found at the outer cutoff, and
/// members pruned from them that may touch it until the next pruning.
class WallContacts {
 public:
  WallContacts(const Kernels& kernels, const Cell& cell);

  /// Finds, for each wall, the grains within `cutoff` [d] of its plane, and the wall grains within
  /// `cutoff` of each. `id` is the permanent id of each grain in memory.
  void build(const double* rows, const std::vector<std::int32_t>& id, const WallPose& pose,
             double cutoff);

  /// Cuts the members from the candidates: those with a wall grain within `cutoff` [d] or the plane
  /// within `cutoff` - d/2.
  void prune(const double* rows, const WallPose& pose, double cutoff);

  /// Sets the wall sums (StepTask::wall_sum) of all members, and returns the sum of the y
  /// components over the contacts with the moving wall, in ascending permanent id [d].
  double evaluate(const double* rows, const WallPose& pose,
                  std::array<AlignedVector<double>, 3>& wall_sum);

  /// 1 for each block of grains in memory that has a member.
  const std::vector<std::uint8_t>& walled() const { return walled_; }
  std::size_t bytes() const;

 private:
  struct Side {
    std::array<double, 2> point, normal;
    std::vector<Eigen::Vector3d> grains;   // its wall grains, in the untilted cell
    std::vector<std::int32_t> active;      // those that a candidate may meet
    AlignedVector<double> rows;            // centres now, and one that nothing touches
    std::vector<std::int32_t> candidates;  // offsets of grains near this wall, ascending id
    std::vector<std::int32_t> near;        // their wall grains, as offsets
    std::vector<std::size_t> near_end;     // end of each candidate's part of `near`
    AlignedVector<std::int32_t> members;   // padded to whole blocks
    std::size_t count = 0;                 // members without padding
    std::vector<std::uint8_t> first;       // whether it is the first wall of each member
    AlignedVector<std::int32_t> list;
    std::vector<std::uint32_t> begin;
    std::vector<std::uint16_t> slots;
    std::vector<double> push;
    std::vector<std::size_t> by_id;  // members in ascending permanent id
  };

  void place(const WallPose& pose);
  void place_side(WallSide which, const WallPose& pose);
  void find_near(Side& side, const double* rows, double cutoff, const WallPose& pose);
  void prune_side(Side& side, const double* rows, double cutoff);
  void write_lists(Side& side);

  const Kernels& kernels_;
  Cell cell_;
  std::int32_t nowhere_ = 0;  // offset of a row among the grains that nothing touches
  std::array<Side, 4> sides_;
  std::vector<std::uint8_t> seen_;  // grains that a wall before has
  std::vector<std::uint8_t> walled_;
  // What is left of the candidates of one side while it is pruned.
  struct Touch {
    std::int32_t grain;
    std::size_t rank, begin, end;  // rank in ascending id; part of touched_
  };
  std::vector<Touch> touches_;
  std::vector<std::int32_t> touched_;
};

}  // namespace shearcell
