// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbour lists: an outer list from a grid search, and an inner list pruned from it, which the
// kernel reads.
//
// If all grains had the same thin margin, bursts of fast grains would require a new search every
// few dozen steps. So the search uses wide margins, the inner list is pruned often, and in both
// lists the margin of a grain grows with its speed. None of this changes a result (kernel.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/cell_order.hpp"
#include "core/kernel.hpp"
#include "core/team.hpp"
#include "core/walls.hpp"

namespace shearcell {

/// These settings change the speed, never the bits.
struct ListSettings {
  double outer_cutoff = 1.25;  ///< of the outer list, for two grains that only follow the shear [d]
  double inner_cutoff = 1.04;  ///< of the inner list, for such grains [d]
  double widest_cutoff = 1.6;  ///< for the fastest grains if the cell is deep enough [d]
  bool rebuild_every_step = false;
  bool sort_memory = true;  ///< keep grains that are near in space near in memory

  double outer_margin() const { return 0.5 * (outer_cutoff - 1); }  ///< smallest [d]
  double inner_margin() const { return 0.5 * (inner_cutoff - 1); }
  /// Largest margin [d], such that no grain is near a neighbour across both ends of the depth.
  double widest_margin(double depth) const;
};

/// Positions when a list was built, in the frame that moves with the affine shear.
///
/// A pair that is not in a list was at least 1 + m_i + m_j apart, with margins m. The pair cannot
/// touch until a grain has moved farther in this frame than its margin, reduced by the part that
/// the shear of the frame has used up. So each grain checks its own margin, and fast grains can
/// have wide margins without longer lists for the others.
class Reference {
 public:
  /// Positions of the grains and the pose of the walls now. `widest` is the largest margin [d].
  void set(const double* rows, std::size_t grains, const WallPose& pose, double widest, Team& team);

  /// Distance [d] of the grain from where it would be if it had only followed the shear.
  double moved(const double* rows, std::size_t grain, const WallPose& pose) const;
  /// Upper bound of this distance [d] for all wall grains and wall planes.
  double wall_moved(const WallPose& pose) const;
  /// Part of every margin used up by the shear since and by rounding of the reference [d].
  double margin_loss(double tan_theta) const;

  /// Height [d] at which the frame does not move.
  double frame_height() const { return pose_.top; }
  /// One coordinate of the grains in the untilted frame, in single precision.
  const float* data(std::size_t axis) const { return at_[axis].data(); }
  std::size_t bytes() const { return 3 * sizeof(float) * at_[0].size(); }

 private:
  std::array<AlignedVector<float>, 3> at_;
  double rounding_ = 0, widest_ = 0;
  WallPose pose_;
};

/// The cell when its lists are built.
struct Snapshot {
  double* rows = nullptr;  ///< as in kernel.hpp; the lists write the margins
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

  /// False when something may have moved beyond its margin in the inner list. `excess` is the
  /// return value of the kernel.
  bool inner_valid(double excess, const WallPose& pose) const;

  /// Sets the margins of all grains and wall grains for a new outer list, at most widest_margin().
  void set_outer_margins(const Snapshot& now);
  /// Builds the outer list and prunes it to the inner list. `order` holds the sites with the
  /// margins of set_outer_margins(); `id` is the permanent id of each grain in memory.
  void build(const Snapshot& now, const std::vector<std::int32_t>& id, const CellOrder& order);
  /// Prunes the inner list again. Returns false, leaving it unusable, when the outer list must be
  /// rebuilt first.
  bool prune(const Snapshot& now);

  /// The widest margin in the newest outer list [d].
  double widest_margin() const { return widest_margin_; }
  NeighbourRows rows() const;
  /// Length of each grain's inner list when it was last pruned; empty before that.
  const std::vector<std::uint16_t>& inner_count() const { return inner_count_; }
  /// The bits of NeighbourRows::near for each grain.
  const std::vector<std::uint8_t>& near() const { return grain_near_; }
  /// Places in memory of the grains that may touch the moving wall, in ascending permanent id.
  const std::vector<std::int32_t>& at_moving_wall() const { return at_moving_wall_; }
  const Reference& reference() const { return inner_reference_; }
  std::size_t bytes() const;

 private:
  void search(const CellOrder& order, std::size_t grains);
  void choose_widest_margin(const Snapshot& now);
  bool set_inner_margins(const Snapshot& now);
  void prune_inner(const Snapshot& now);

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
