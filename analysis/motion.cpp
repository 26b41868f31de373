// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/motion.hpp"

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <limits>

#include "analysis/error.hpp"
#include "analysis/near_grains.hpp"
#include "core/contact.hpp"

namespace shearcell {
namespace {

Eigen::Matrix3Xd untilted(const Checkpoint& checkpoint) {
  const WallPose pose = pose_of(checkpoint);
  Eigen::Matrix3Xd position = checkpoint.state.position;
  position.row(0).array() -= pose.tan_theta * (position.row(1).array() - pose.top);
  return position;
}

// Sums over one grain's neighbours, from which the best affine deformation follows.
struct Neighbours {
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();  // later x earlier
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();   // earlier x earlier
  double later = 0;                                   // sum of squares
  int count = 0;

  void add(const Eigen::Vector3d& earlier_r, const Eigen::Vector3d& later_r) {
    product += later_r * earlier_r.transpose();
    square += earlier_r * earlier_r.transpose();
    later += later_r.squaredNorm();
    ++count;
  }

  // With the best deformation F = X Y^-1, sum |r' - F r|^2 = sum |r'|^2 - tr(F X^T).
  double nonaffine() const {
    // Neighbours in one plane do not determine the deformation.
    const double flat = 1e-9 * std::pow(square.trace() / 3, 3);
    if (count < 4 || !(square.determinant() > flat)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const Eigen::Matrix3d deformation = product * square.inverse();
    return std::max(0.0, later - (deformation * product.transpose()).trace()) / count;
  }
};

}  // namespace

Motion motion(const Checkpoint& earlier, const Checkpoint& later) {
  if (earlier.state.position.cols() != later.state.position.cols()) {
    throw AnalysisError("two checkpoints of one run have different numbers of grains");
  }
  const Eigen::Matrix3Xd from = untilted(earlier), to = untilted(later);
  Motion found;
  found.displacement = to - from;
  std::vector<Neighbours> neighbours(static_cast<std::size_t>(from.cols()));
  for_each_pair(earlier.cell, pose_of(earlier), earlier.state.position, motion_neighbour_d,
                [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d&) {
                  Eigen::Vector3d before = from.col(j) - from.col(i);
                  before.z() =
                      nearest_image(before.z(), earlier.cell.depth, 1 / earlier.cell.depth);
                  const Eigen::Vector3d after =
                      before + found.displacement.col(j) - found.displacement.col(i);
                  neighbours[static_cast<std::size_t>(i)].add(before, after);
                  neighbours[static_cast<std::size_t>(j)].add(-before, -after);
                });
  found.nonaffine.reserve(neighbours.size());
  for (const Neighbours& of_grain : neighbours) found.nonaffine.push_back(of_grain.nonaffine());
  return found;
}

Motion motion_since(const std::optional<Checkpoint>& earlier, const Checkpoint& now) {
  if (earlier) return motion(*earlier, now);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Index grains = now.state.position.cols();
  return {Eigen::Matrix3Xd::Constant(3, grains, unknown),
          std::vector<double>(static_cast<std::size_t>(grains), unknown)};
}

std::vector<std::uint8_t> crystal_boundary(const Checkpoint& checkpoint,
                                           std::span<const std::uint8_t> crystalline) {
  std::vector<std::uint8_t> boundary(crystalline.size(), 0);
  for_each_pair(checkpoint.cell, pose_of(checkpoint), checkpoint.state.position, motion_neighbour_d,
                [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d&) {
                  const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
                  if (crystalline[a] == crystalline[b]) return;
                  boundary[crystalline[a] != 0 ? a : b] = 1;
                });
  return boundary;
}

}  // namespace shearcell
