// SPDX-License-Identifier: GPL-3.0-or-later
// Positions when a list was built, in the frame that moves with the affine shear.
//
// A pair that is not in a list was at least 1 + m_i + m_j apart, with margins m. It cannot touch
// until a grain has moved farther in that frame than its margin, less the part that the shear of
// the frame has used up since. So each grain checks its own margin, and fast grains can have wide
// ones without longer lists for the others.
#pragma once

#include <array>
#include <cstddef>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/team.hpp"

namespace shearcell {

class Reference {
 public:
  /// Positions of the grains and the pose of the walls now. `widest` is the largest margin [d].
  void set(const double* rows, std::size_t grains, const WallPose& pose, double widest, Team& team);

  /// Distance [d] of the grain from where it would be if it had only followed the shear.
  double moved(const double* rows, std::size_t grain, const WallPose& pose) const;
  /// Upper bound of the same for all wall grains and wall planes.
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

}  // namespace shearcell
