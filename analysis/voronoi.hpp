// SPDX-License-Identifier: GPL-3.0-or-later
// Voronoi cells of the grains in a sheared cell: wall grains as further sites, walls as clips.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell.hpp"

namespace shearcell {

enum class NeighbourKind : std::uint8_t { grain, wall_grain, wall_plane };

/// One face of a grain's Voronoi cell.
struct VoronoiFace {
  /// From the grain to the nearest image of the neighbour; for a wall plane, to the grain's mirror
  /// image behind it [d].
  Eigen::Vector3d to_neighbour;
  double area;             ///< A_ij [d^2]
  std::int32_t neighbour;  ///< grain id, place in Cell::wall_grains, or WallSide
  NeighbourKind kind;
};

/// Column i of each array belongs to the grain with permanent id i.
struct VoronoiDiagram {
  std::vector<double> volume;      ///< V_cell,i [d^3]
  std::vector<double> surface;     ///< A_i, the sum over all faces, wall planes included [d^2]
  std::vector<std::size_t> first;  ///< n + 1 entries: faces of grain i are first[i] .. first[i+1]
  std::vector<VoronoiFace> faces;
  /// Volumes of the wall grains' cells inside the walls [d^3]; empty unless asked for.
  std::vector<double> wall_grain_volume;

  std::span<const VoronoiFace> faces_of(std::size_t grain) const {
    return {faces.data() + first[grain], first[grain + 1] - first[grain]};
  }
};

enum class WallGrainCells : std::uint8_t { skip, measure };

/// Cells of `grains` (3 x n [d], z unwrapped and periodic with cell.depth), inside the walls in the
/// given pose. With WallGrainCells::measure the volumes of all cells add up to that of the sheared
/// box.
///
/// Cells are the dual of CGAL's Delaunay triangulation of sites and images: polygons of
/// circumcentres, clipped by the walls. The faces of a grain are in ascending order of kind,
/// neighbour and image. Faces no larger than 1e-13 d^2 are rounding and left out.
///
/// Throws AnalysisError, naming the grains, when two sites coincide or a grain lies on or outside a
/// wall plane, and when the cell has no volume.
VoronoiDiagram voronoi(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains,
                       WallGrainCells wall_grain_cells = WallGrainCells::skip);

/// Sites for neighbour searches: the grains, then the wall grains, with z wrapped into one period.
Eigen::Matrix3Xd wrapped_sites(const Cell& cell, const WallPose& pose,
                               const Eigen::Matrix3Xd& grains);

/// Signed distances [d] of a point from the four wall planes, by WallSide; positive inside. The
/// distance from a tilted side plane is measured along its normal.
Eigen::Vector4d wall_distances(const Cell& cell, const WallPose& pose,
                               const Eigen::Vector3d& point);

}  // namespace shearcell
