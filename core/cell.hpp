// SPDX-License-Identifier: GPL-3.0-or-later
// The cell around the grains: two tilting side walls, a fixed and a moving wall, periodic in z.
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
inline constexpr auto kNames<WallSide> = names_in_order<WallSide>("left", "right", "bottom", "top");
template <>
inline constexpr auto kNames<WallTexture> = names_in_order<WallTexture>("rough", "smooth");
template <>
inline constexpr auto kNames<MovingWall> = names_in_order<MovingWall>("bottom", "top");

/// A sphere of diameter d fixed to a rough wall.
struct WallGrain {
  WallSide side;
  /// Centre [d] while the cell is untilted and the planes are at Cell::bottom and Cell::top.
  Eigen::Vector3d position;
};

/// Largest width or height of a cell [d]. Neighbour lists store positions in single precision, and
/// the rounding errors must stay below the margins of the lists.
inline constexpr double kLongestCell = 1e5;

/// Smallest depth of a cell [d]. In a shallower cell, a grain could touch two periodic images of
/// the same neighbour.
inline constexpr double kShallowestCell = 3;

/// Largest allowed V / (N + 100) of a cell of volume V with N grains [d^3]. This limits the memory
/// of the analysis, for example of profiles with one value for each horizontal layer of the cell.
inline constexpr double kLoosestCell = 1e4;

/// Geometry that does not change during a run. Lengths are in grain diameters d.
///
/// x is the shear direction, y points up, z is the depth and periodic. In the untilted cell the
/// side planes lie at x = 0 and x = width, the horizontal planes at y = bottom and y = top.
struct Cell {
  double width = 0;   ///< L, distance between the side planes [d]
  double depth = 0;   ///< period in z [d]
  double bottom = 0;  ///< initial height of the bottom plane [d]
  double top = 0;     ///< initial height of the top plane [d]
  MovingWall moving = MovingWall::bottom;
  std::vector<WallGrain> wall_grains = {};  ///< empty for smooth walls; the order never changes
};

/// Tilt and heights of the walls at one instant. The top wall is fixed in x. A wall point at height
/// y is displaced in x by (y - top) tan(theta).
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

/// Direction from the moving wall into the cell: 1 (up) for the bottom wall, -1 for the top wall.
inline double inwards(const Cell& cell) {
  return cell.moving == MovingWall::bottom ? 1 : -1;
}

/// A wall plane, given in x and y by a point [d] and the unit normal that points into the cell.
struct WallPlane {
  double point[2] = {}, normal[2] = {};
};

/// Distance of the point (x, y) from a plane [d], positive inside the cell.
inline double distance_to(const WallPlane& plane, double x, double y) {
  return (x - plane.point[0]) * plane.normal[0] + (y - plane.point[1]) * plane.normal[1];
}

/// The four wall planes at the given pose, indexed by WallSide.
std::array<WallPlane, 4> wall_planes(const Cell& cell, const WallPose& pose);

/// The pose at tilt angle `theta` [rad] with the moving wall at `wall_height` [d]. The result has
/// the same bits on every machine.
WallPose wall_pose(const Cell& cell, double theta, double wall_height);

/// Centre of one wall grain at the given pose [d].
Eigen::Vector3d wall_grain_position(const Cell& cell, const WallPose& pose, const WallGrain& grain);

/// Centres of all wall grains at the given pose, 3 x n [d], in the order of Cell::wall_grains.
Eigen::Matrix3Xd wall_grain_positions(const Cell& cell, const WallPose& pose);

/// Velocities of all wall grains [d/s] while tan(theta) changes at `shear_rate` [1/s] and the
/// moving wall moves at `wall_velocity` [d/s].
Eigen::Matrix3Xd wall_grain_velocities(const Cell& cell, const WallPose& pose, double shear_rate,
                                       double wall_velocity);

}  // namespace shearcell
