// SPDX-License-Identifier: GPL-3.0-or-later
// Which grains may touch: an outer list found in linked cells, and an inner one pruned from it.
//
// Bursts of fast grains make any single thin skin expire every few dozen steps, so the costly
// search is done at a wide cutoff and the list that the kernel walks is often cut down from that.
// Both lists are valid as long as no pair outside them can touch. Displacements are counted in the
// frame that moves with the affine shear; the shear itself is bounded by the strain since the list
// was made. The choice of cutoffs never changes a result (kernel.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/cell_grid.hpp"
#include "core/kernel.hpp"
#include "core/team.hpp"

namespace shearcell {

/// How the lists are kept. These change the speed, never the bits.
struct ListSettings {
  double outer_cutoff = 1.4;   ///< [d]
  double inner_cutoff = 1.08;  ///< [d]
  bool rebuild_every_step = false;
  bool sort_memory = true;  ///< keep grains that are near in space near in memory
};

/// Positions and pose that displacements are counted from.
class Reference {
 public:
  void set(const double* rows, std::size_t grains, const WallPose& pose);
  /// Largest distance [d] that a grain has moved since, apart from the affine shear.
  double farthest(const double* rows, std::size_t grains, const WallPose& pose) const;
  /// Largest distance that a wall grain or wall plane has moved since, apart from the shear.
  double wall_travel(const WallPose& pose) const;
  /// Lower bound of what a separation of length 1 has shrunk to by the affine shear since.
  double stretch(const WallPose& pose) const;
  /// Bound of the error of `farthest`, and of what the kernel finds: positions are kept in single
  /// precision here.
  double rounding() const { return rounding_; }
  const float* data(std::size_t axis) const { return at_[axis].data(); }

 private:
  std::array<AlignedVector<float>, 3> at_;  // x is that in the untilted frame, top wall as origin
  double rounding_ = 0;
  WallPose pose_;
};

class NeighbourLists {
 public:
  NeighbourLists(const Kernels& kernels, const ListSettings& settings, double depth, Team& team);

  /// False when, at the cutoff of the inner list, a pair outside it may touch now.
  bool inner_valid(double farthest, const WallPose& pose) const;
  /// False when a pair outside the outer list may come within the inner cutoff now.
  bool outer_valid(const double* rows, std::size_t grains, const WallPose& pose) const;

  /// Finds all pairs within the outer cutoff. `order` holds the grains; `id` orders each row.
  void build(const double* rows, const std::vector<std::int32_t>& id, const CellOrder& order,
             const WallPose& pose);
  /// Cuts the inner list from the outer one.
  void prune(const double* rows, std::size_t grains, const WallPose& pose);

  NeighbourRows rows() const { return {inner_.data(), begin_.data(), slots_.data(), seam_.data()}; }
  /// Length of each grain's inner list when it was last pruned; empty before that.
  const std::vector<std::uint16_t>& inner_count() const { return inner_count_; }
  const Reference& reference() const { return inner_reference_; }
  std::size_t bytes() const;

 private:
  const Kernels& kernels_;
  Team& team_;
  ListSettings settings_;
  double depth_;
  Reference outer_reference_, inner_reference_;
  std::size_t outer_stride_ = 32, inner_stride_ = 16;
  AlignedVector<std::int32_t> outer_, inner_;
  std::vector<std::int32_t> offset_of_id_;
  std::vector<std::uint16_t> outer_count_, inner_count_, slots_;
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint8_t> seam_;
};

}  // namespace shearcell
