// SPDX-License-Identifier: GPL-3.0-or-later
// Two kinds of neighbour lists. A grid search makes the outer lists. Pruning the outer lists makes
// the inner lists, which the kernel reads.
//
// With the same narrow margin for all grains, bursts of fast grains would require a new search
// every few dozen steps. So the search uses wide margins, the inner lists are pruned often, and in
// both lists a faster grain has a wider margin. The lists never change a result (kernel.hpp).
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

/// Settings of the neighbour lists. They affect the speed, but not a single bit of the results.
struct ListSettings {
  double outer_cutoff = 1.25;  ///< outer cutoff for two grains that move only with the shear [d]
  double inner_cutoff = 1.04;  ///< inner cutoff for two grains that move only with the shear [d]
  double widest_cutoff = 1.6;  ///< cutoff for the fastest grains [d]; less in a shallow cell
  bool rebuild_every_step = false;
  bool sort_memory = true;  ///< store neighbouring grains close together in memory

  double outer_margin() const { return 0.5 * (outer_cutoff - 1); }  ///< smallest outer margin [d]
  double inner_margin() const { return 0.5 * (inner_cutoff - 1); }
  /// Largest margin [d]. It is limited so that a list never needs two images of one neighbour.
  double widest_margin(double depth) const;
};

/// Positions of the grains when a list was built, in the frame that moves with the affine shear.
///
/// Two grains that are not listed as neighbours were at least 1 + m_i + m_j apart, where m_i and
/// m_j are their margins. They cannot touch until one of them has moved in this frame by more than
/// its margin minus margin_loss(). So the movement of each grain is compared with its own margin
/// only. The wide margin of a fast grain adds to the lists only pairs that contain this grain.
class Reference {
 public:
  /// Stores the present positions and the present pose. `widest` is the largest margin [d].
  void set(const double* rows, std::size_t grains, const WallPose& pose, double widest, Team& team);

  /// Distance [d] of the grain from the position to which the shear alone would have moved it.
  double moved(const double* rows, std::size_t grain, const WallPose& pose) const;
  /// Upper bound of moved() [d] for all wall grains and wall planes.
  double wall_moved(const WallPose& pose) const;
  /// Part of each margin [d] that is used up by the shear since set() and by the rounding of
  /// positions.
  double margin_loss(double tan_theta) const;

  /// Height [d] of the top wall at set(). The shear displacement is zero at this height.
  double frame_height() const { return pose_.top; }
  /// One coordinate of all grains in the untilted frame [d], in single precision.
  const float* data(std::size_t axis) const { return at_[axis].data(); }
  std::size_t bytes() const { return 3 * sizeof(float) * at_[0].size(); }

 private:
  std::array<AlignedVector<float>, 3> at_;
  double rounding_ = 0, widest_ = 0;
  WallPose pose_;
};

/// State of the cell when lists are built or pruned.
struct Snapshot {
  double* rows = nullptr;  ///< rows as in kernel.hpp; NeighbourLists sets the margin in each
  const double* velocity[3] = {};
  std::size_t grains = 0;
  WallPose pose;
  double time_step = 0;   ///< [s]
  double shear_rate = 0;  ///< rate of change of tan(theta) [1/s]
  double wall_speed = 0;  ///< speed of the moving wall [d/s]
  std::uint64_t step = 0;
};

class NeighbourLists {
 public:
  /// `kernels`, `walls` and `team` must outlive the lists.
  NeighbourLists(const Kernels& kernels, const ListSettings& settings, double depth,
                 const Walls& walls, Team& team);

  /// Whether the inner lists are valid. They are invalid if a grain or wall may have moved by more
  /// than the margin of this grain or wall. `excess` is the return value of Kernels::step.
  bool inner_valid(double excess, const WallPose& pose) const;

  /// Sets all margins for new outer lists. No margin exceeds widest_margin().
  void set_outer_margins(const Snapshot& now);
  /// Builds the outer lists and the inner lists. `order` must hold the sites with the margins from
  /// set_outer_margins(). `id` holds the permanent ids of the grains in memory order.
  void build(const Snapshot& now, const std::vector<std::int32_t>& id, const CellOrder& order);
  /// Makes new inner lists from the outer lists. Returns false if the outer lists must be rebuilt
  /// first. The inner lists are then invalid.
  bool prune(const Snapshot& now);

  /// Upper limit of the margins in the newest outer lists [d].
  double widest_margin() const { return widest_margin_; }
  NeighbourRows rows() const;
  /// Length of the inner list of each grain; empty before the first lists are built.
  const std::vector<std::uint16_t>& inner_count() const { return inner_count_; }
  /// The flags kNearSeam, kNearMovingWall and kNearOtherWall of each grain.
  const std::vector<std::uint8_t>& near() const { return grain_near_; }
  /// Memory indices of the grains that may touch the moving wall, in ascending permanent id.
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
  std::uint64_t built_at_ = 0;  // step when the outer lists were last built
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
