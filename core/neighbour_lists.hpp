// SPDX-License-Identifier: GPL-3.0-or-later
// What each grain may touch: an outer list found in a grid of cells, and an inner one pruned from
// it.
//
// Bursts of fast grains would make any single thin skin expire every few dozen steps. So the costly
// search is done for wide margins, the list that the kernel walks is often cut down from that, and
// a grain's margin in both (reference.hpp) grows with its speed. None of this changes a result
// (kernel.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/cell_grid.hpp"
#include "core/kernel.hpp"
#include "core/reference.hpp"
#include "core/team.hpp"
#include "core/walls.hpp"

namespace shearcell {

/// How the lists are kept. These change the speed, never the bits.
struct ListSettings {
  double outer_cutoff = 1.25;  ///< of two grains that only follow the shear [d]
  double inner_cutoff = 1.04;  ///< the same for the inner list
  double widest_cutoff = 1.4;  ///< of the fastest grains [d]
  double outer_horizon = 500;  ///< time steps that a fast grain's margin should last
  double inner_horizon = 80;   ///< the same for the inner list
  bool rebuild_every_step = false;
  bool sort_memory = true;  ///< keep grains that are near in space near in memory

  double outer_margin() const { return 0.5 * (outer_cutoff - 1); }  ///< smallest [d]
  double inner_margin() const { return 0.5 * (inner_cutoff - 1); }
  double widest_margin() const;
};

/// The cell at the moment when its lists are made.
struct Snapshot {
  double* rows = nullptr;  ///< kernel.hpp's; the margins in them are for the lists to write
  const double* velocity[3] = {};
  std::size_t grains = 0;
  WallPose pose;
  double time_step = 0;   ///< [s]
  double shear_rate = 0;  ///< of tan(theta) [1/s]
  double wall_speed = 0;  ///< of the moving wall [d/s]
  std::uint64_t step = 0;
};

class NeighbourLists {
 public:
  /// `walls` must outlive the lists.
  NeighbourLists(const Kernels& kernels, const ListSettings& settings, double depth,
                 const Walls& walls, Team& team);

  /// False when something may have moved beyond its margin in the inner list. `excess` is what the
  /// kernel's step returned.
  bool inner_valid(double excess, const WallPose& pose) const;

  /// Gives every grain and wall grain the margin of a new outer list, none above widest_margin().
  void set_outer_margins(const Snapshot& now);
  /// Finds the outer neighbours and cuts the inner list from them. `order` holds the sites with
  /// those margins; `id` is the permanent id of each grain in memory.
  void build(const Snapshot& now, const std::vector<std::int32_t>& id, const CellOrder& order);
  /// Cuts the inner list anew. Returns false, leaving it unusable, when the outer list has to be
  /// made again first.
  bool prune(const Snapshot& now);

  /// Of the newest outer list [d].
  double widest_margin() const { return widest_margin_; }
  NeighbourRows rows() const;
  /// Length of each grain's inner list when it was last cut; empty before that.
  const std::vector<std::uint16_t>& inner_count() const { return inner_count_; }
  /// What each grain is near to: bits of NeighbourRows::near.
  const std::vector<std::uint8_t>& near() const { return grain_near_; }
  /// Places in memory of the grains that may touch the moving wall, in ascending permanent id.
  const std::vector<std::int32_t>& at_moving_wall() const { return at_moving_wall_; }
  const Reference& reference() const { return inner_reference_; }
  std::size_t bytes() const;

 private:
  void search(const CellOrder& order, std::size_t grains);
  void choose_widest_margin(const Snapshot& now);
  bool set_inner_margins(const Snapshot& now);
  void cut(const Snapshot& now);

  const Kernels& kernels_;
  const Walls& walls_;
  Team& team_;
  ListSettings settings_;
  double depth_;
  double widest_margin_;
  std::uint64_t built_at_ = 0;  // step of the newest outer list
  double outer_wall_margin_ = 0, inner_wall_margin_ = 0;
  Reference outer_reference_, inner_reference_;
  AlignedVector<float> outer_margin_;
  std::size_t outer_stride_ = 32, inner_stride_ = 16;
  AlignedVector<std::int32_t> outer_, inner_;
  std::vector<std::int32_t> offset_of_id_, at_moving_wall_;
  std::vector<std::uint16_t> outer_count_, inner_count_, other_slots_, moving_wall_slots_;
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint8_t> near_, grain_near_;
};

}  // namespace shearcell
