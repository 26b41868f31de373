// SPDX-License-Identifier: GPL-3.0-or-later
// Voronoi cells of the grains in a sheared cell. Wall grains are sites too; walls clip the cells.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell.hpp"

namespace shearcell {

enum class NeighbourKind : std::uint8_t { grain, wall_grain, wall_plane };

struct VoronoiFace {
  /// Vector from the grain to the periodic image of the neighbour across the face [d]. For a wall
  /// plane it ends at the grain's mirror image behind the plane.
  Eigen::Vector3d to_neighbour;
  double area;             ///< A_ij [d^2]
  std::int32_t neighbour;  ///< grain id, index in Cell::wall_grains, or WallSide
  NeighbourKind kind;
};

/// Arrays have one entry per grain, by permanent id; `faces` has the faces of all grains.
struct VoronoiDiagram {
  std::vector<double> volume;      ///< V_cell,i [d^3]
  std::vector<double> surface;     ///< A_i, area of all faces including those on walls [d^2]
  std::vector<std::size_t> first;  ///< n + 1 entries: grain i has faces first[i] to first[i+1] - 1
  std::vector<VoronoiFace> faces;

  std::span<const VoronoiFace> faces_of(std::size_t grain) const {
    return {faces.data() + first[grain], first[grain + 1] - first[grain]};
  }
};

/// Computes the cells of `grains` (3 x n [d], z unwrapped and periodic with cell.depth) inside the
/// walls at `pose`. Wall grains also have cells, but these are not returned. If there are no wall
/// grains, the volumes of the cells add up to the volume of the sheared box.
///
/// The cells are dual to CGAL's Delaunay triangulation of the sites and their periodic images:
/// faces are polygons of circumcentres, clipped by the walls. The faces of a grain are in ascending
/// order of kind, neighbour and image. Faces of at most 1e-13 d^2 are rounding errors and left out.
///
/// Throws AnalysisError if two sites coincide, or if a grain is on or outside a wall plane; the
/// message then names these grains. Also throws AnalysisError if a position is not finite, or
/// if the sheared box has no volume.
VoronoiDiagram voronoi(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains);

/// Sites for neighbour searches: grains, then wall grains, with z wrapped into one period.
Eigen::Matrix3Xd wrapped_sites(const Cell& cell, const WallPose& pose,
                               const Eigen::Matrix3Xd& grains);

/// Signed distances [d] of a point from the four wall planes, by WallSide; positive inside. The
/// distance from a tilted side plane is measured along its normal.
Eigen::Vector4d wall_distances(const Cell& cell, const WallPose& pose,
                               const Eigen::Vector3d& point);

}  // namespace shearcell
