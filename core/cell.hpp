// SPDX-License-Identifier: GPL-3.0-or-later
// The box that holds the grains: four walls, two of which tilt, one of which moves; periodic in z.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/named.hpp"

namespace shearcell {

enum class WallSide : std::uint8_t { left = 0, right = 1, bottom = 2, top = 3 };
enum class WallTexture : std::uint8_t { rough, smooth };
enum class MovingWall : std::uint8_t { bottom, top };
template <>
inline constexpr auto kNames<WallTexture> = names_in_order<WallTexture>("rough", "smooth");
template <>
inline constexpr auto kNames<MovingWall> = names_in_order<MovingWall>("bottom", "top");

/// A sphere of diameter d fixed to a rough wall.
struct WallGrain {
  WallSide side;
  /// Centre [d] in the untilted cell, while the plane of its wall is at its height in `Cell`.
  Eigen::Vector3d position;
};

/// The largest width or height of a cell [d]. Neighbour lists have positions in single precision,
/// whose rounding must be below their margins.
inline constexpr double kLongestCell = 1e5;

/// The smallest depth [d]: in a shallower cell a grain could touch another one across both periodic
/// boundaries.
inline constexpr double kShallowestCell = 3;

/// The largest volume of a cell, divided by N + 100 [d^3]. This limits the memory of an analysis,
/// which is proportional to the number of layers in the cell.
inline constexpr double kLoosestCell = 1e4;

/// Geometry that does not change during a run. Lengths in grain diameters d.
///
/// x is the shear direction, y points up, z is the depth and periodic. In the untilted cell the
/// side planes lie at x = 0 and x = width, the horizontal planes at y = bottom and y = top.
struct Cell {
  double width = 0;   ///< L, distance of the side planes [d]
  double depth = 0;   ///< period in z [d]
  double bottom = 0;  ///< height of the bottom plane before it moves [d]
  double top = 0;     ///< height of the top plane before it moves [d]
  MovingWall moving = MovingWall::bottom;
  std::vector<WallGrain> wall_grains = {};  ///< empty when the walls are smooth; order is permanent
};

/// The walls at one instant. The side walls tilt about the top wall, which is fixed in x: a wall
/// point at height y is displaced by (y - top) tan(theta).
struct WallPose {
  double tan_theta = 0;
  double cos_theta = 1;
  double sin_theta = 0;
  double bottom = 0;  ///< height of the bottom plane [d]
  double top = 0;     ///< height of the top plane [d]
};

inline WallSide moving_side(const Cell& cell) {
  return cell.moving == MovingWall::bottom ? WallSide::bottom : WallSide::top;
}

/// 1 if the cell lies above the moving wall, -1 if it lies below.
inline double inwards(const Cell& cell) {
  return cell.moving == MovingWall::bottom ? 1 : -1;
}

/// A wall plane in the plane of shear: a point and the unit normal into the cell.
struct WallPlane {
  double point[2] = {}, normal[2] = {};
};

/// Distance of a place from a plane [d], positive inside the cell.
inline double distance_to(const WallPlane& plane, double x, double y) {
  return (x - plane.point[0]) * plane.normal[0] + (y - plane.point[1]) * plane.normal[1];
}

/// The planes in a pose, indexed by WallSide.
std::array<WallPlane, 4> wall_planes(const Cell& cell, const WallPose& pose);

/// The pose at a tilt angle [rad] and a height of the moving plane [d]. It has the same bits on
/// every machine.
WallPose wall_pose(const Cell& cell, double theta, double wall_height);

/// Centre of one wall grain in a pose [d].
Eigen::Vector3d wall_grain_position(const Cell& cell, const WallPose& pose, const WallGrain& grain);

/// Centres of all wall grains in a pose, 3 x n [d], in their permanent order.
Eigen::Matrix3Xd wall_grain_positions(const Cell& cell, const WallPose& pose);

/// Velocities of all wall grains [d/s] while tan(theta) changes at `shear_rate` [1/s] and the
/// moving wall moves at `wall_velocity` [d/s].
Eigen::Matrix3Xd wall_grain_velocities(const Cell& cell, const WallPose& pose, double shear_rate,
                                       double wall_velocity);

}  // namespace shearcell
