// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/cell.hpp"

#include "core/trigonometry.hpp"

namespace shearcell {

WallPose wall_pose(const Cell& cell, double theta, double wall_height) {
  const SineCosine sc = sine_cosine(theta);
  return {.tan_theta = sc.sine / sc.cosine,
          .cos_theta = sc.cosine,
          .sin_theta = sc.sine,
          .bottom = cell.moving == MovingWall::bottom ? wall_height : cell.bottom,
          .top = cell.moving == MovingWall::top ? wall_height : cell.top};
}

std::array<WallPlane, 4> wall_planes(const Cell& cell, const WallPose& pose) {
  const double c = pose.cos_theta;
  const double s = pose.sin_theta;
  // The side planes pass through the ends of the top wall, which is fixed in x.
  return {WallPlane{{0, pose.top}, {c, -s}}, WallPlane{{cell.width, pose.top}, {-c, s}},
          WallPlane{{0, pose.bottom}, {0, 1}}, WallPlane{{0, pose.top}, {0, -1}}};
}

Eigen::Vector3d wall_grain_position(const Cell& cell, const WallPose& pose,
                                    const WallGrain& grain) {
  Eigen::Vector3d p = grain.position;
  switch (grain.side) {
    case WallSide::left:
    case WallSide::right:
      p.x() += (p.y() - pose.top) * pose.tan_theta;
      break;
    case WallSide::bottom:  // the grains of this wall move as one rigid body
      p.x() += (pose.bottom - pose.top) * pose.tan_theta;
      p.y() += pose.bottom - cell.bottom;
      break;
    case WallSide::top:
      p.y() += pose.top - cell.top;
      break;
  }
  return p;
}

Eigen::Matrix3Xd wall_grain_positions(const Cell& cell, const WallPose& pose) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(cell.wall_grains.size()));
  Eigen::Index column = 0;
  for (const WallGrain& grain : cell.wall_grains) {
    positions.col(column++) = wall_grain_position(cell, pose, grain);
  }
  return positions;
}

Eigen::Matrix3Xd wall_grain_velocities(const Cell& cell, const WallPose& pose, double shear_rate,
                                       double wall_velocity) {
  const double bottom = cell.moving == MovingWall::bottom ? wall_velocity : 0;
  const double top = cell.moving == MovingWall::top ? wall_velocity : 0;
  Eigen::Matrix3Xd velocities(3, static_cast<Eigen::Index>(cell.wall_grains.size()));
  Eigen::Index column = 0;
  for (const auto& [side, p] : cell.wall_grains) {
    const double y = side == WallSide::bottom ? pose.bottom : p.y();
    const double rise = side == WallSide::bottom ? bottom : 0;
    // Adding +0 turns -0 into +0.
    const double along = (y - pose.top) * shear_rate + (rise - top) * pose.tan_theta + 0.0;
    velocities.col(column++) =
        side == WallSide::top ? Eigen::Vector3d(0, top, 0) : Eigen::Vector3d(along, rise, 0);
  }
  return velocities;
}

}  // namespace shearcell
