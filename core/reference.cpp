// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reference.hpp"

#include <algorithm>
#include <cmath>

#include "core/kernel.hpp"

namespace shearcell {

void Reference::set(const double* rows, std::size_t grains, const WallPose& pose, double widest,
                    Team& team) {
  pose_ = pose;
  widest_ = widest;
  for (auto& axis : at_) axis.resize(padded(grains));
  const double largest = team.largest(grains, [&](std::size_t first, std::size_t last) {
    double coordinate = 0;
    for (std::size_t g = first; g < last; ++g) {
      const double* p = rows + 4 * g;
      coordinate = std::max({coordinate, std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])});
      at_[0][g] = static_cast<float>(p[0] - pose.tan_theta * (p[1] - pose.top));
      at_[1][g] = static_cast<float>(p[1]);
      at_[2][g] = static_cast<float>(p[2]);
    }
    return coordinate;
  });
  rounding_ = 0x1p-22 * largest;  // half a unit in the last place is 2^-25 of a coordinate at most
}

double Reference::moved(const double* rows, std::size_t grain, const WallPose& pose) const {
  const double* p = rows + 4 * grain;
  const double y = double{at_[1][grain]};
  const double wx = p[0] - (double{at_[0][grain]} + pose.tan_theta * (y - pose_.top));
  const double wy = p[1] - y;
  const double wz = p[2] - double{at_[2][grain]};
  return std::sqrt(wx * wx + wy * wy + wz * wz);
}

double Reference::wall_moved(const WallPose& pose) const {
  // Side walls follow the shear about the top wall. The bottom's wall grains move in x with its
  // plane: a grain up to d behind the plane differs from the shear by the strain times that
  // distance.
  const double travel =
      std::max(std::fabs(pose.bottom - pose_.bottom), std::fabs(pose.top - pose_.top));
  return travel * (1 + std::fabs(pose.tan_theta)) + std::fabs(pose.tan_theta - pose_.tan_theta);
}

double Reference::margin_loss(double tan_theta) const {
  // The smallest singular value of a simple shear e is sqrt(1 + e^2/4) - e/2 > 1 - e/2. A distance
  // of 1 plus two margins shrinks by at most that factor; each of the two grains bears half of the
  // loss.
  return 0.25 * std::fabs(tan_theta - pose_.tan_theta) * (1 + 2 * widest_) + rounding_ + 1e-9;
}

}  // namespace shearcell
