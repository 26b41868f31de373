// SPDX-License-Identifier: GPL-3.0-or-later
// Where everything was when a list was made, in the frame that moves with the affine shear.
//
// A pair that a list leaves out was at least 1 + m_i + m_j apart, with a margin m for each. Until a
// grain has moved farther in that frame than its margin, less what the shear of the frame itself
// can have taken since, no such pair can touch. So each grain watches over its own margin, and fast
// grains can have wide ones without a longer list for the others.
#pragma once

#include <array>
#include <cstddef>

#include "core/aligned.hpp"
#include "core/cell.hpp"

namespace shearcell {

class Reference {
 public:
  /// Positions of the grains and the pose of the walls now. `widest` is the largest margin [d].
  void set(const double* rows, std::size_t grains, const WallPose& pose, double widest);

  /// How far [d] the grain is from where it would be had it only followed the shear.
  double moved(const double* rows, std::size_t grain, const WallPose& pose) const;
  /// Bound of the same for every wall grain and wall plane.
  double wall_moved(const WallPose& pose) const;
  /// What the shear since, and the rounding of what is kept here, have taken from every margin [d].
  double margin_loss(double tan_theta) const;

  /// Height [d] at which the frame stands still.
  double frame_height() const { return pose_.top; }
  /// One coordinate of the grains in the untilted frame; single precision, of which `loss` knows.
  const float* data(std::size_t axis) const { return at_[axis].data(); }
  std::size_t bytes() const { return 3 * sizeof(float) * at_[0].size(); }

 private:
  std::array<AlignedVector<float>, 3> at_;
  double rounding_ = 0, widest_ = 0;
  WallPose pose_;
};

}  // namespace shearcell
