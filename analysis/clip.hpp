// SPDX-License-Identifier: GPL-3.0-or-later
// A convex polyhedron cut by one half-space after another, each corner's side decided exactly.
//
// Three properties make this exact:
//  1. A corner is the meeting point of three planes and is stored as those three, oriented so that
//     det(n_a, n_b, n_c) > 0. Its coordinates are computed from the planes themselves, never from
//     other corners, so no error accumulates.
//  2. Which side of a plane a corner lies on is decided in doubles where a forward error bound
//     allows, and otherwise by an exact determinant (CGAL's exact floats). A corner on the plane
//     counts as inside. That is the same as pushing each later plane outward by an infinitesimal
//     larger than all before it, so however many sites share a sphere, the polyhedron stays simple.
//  3. The corners cut away then form a disc. An edge of that disc borders exactly one of them,
//     which a small table of plane pairs shows without any adjacency being stored.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shearcell {

/// {x : normal . x <= offset}, in a frame whose origin is the site of the cell.
struct HalfSpace {
  Eigen::Vector3d normal;
  double offset;
  double length;  ///< of the normal
  bool bisector;  ///< offset stands for |normal|^2 / 2 without its rounding
};

/// The points nearer to the origin than to `site`.
HalfSpace bisector_to(const Eigen::Vector3d& site);

/// The side of a plane with unit `normal` at signed distance `offset` from the origin.
HalfSpace plane_at(const Eigen::Vector3d& normal, double offset);

/// No cell of a packing has so many planes. The tables grow as the square of the number of planes,
/// and the number of a corner, which is less than twice that of the planes, has 16 bits.
inline constexpr std::size_t most_planes = 4096;

/// Reuse one object for many cells: it keeps its memory. Not for use by two threads at once.
class ConvexCell {
 public:
  /// Starts from six half-spaces in the order -x, +x, -y, +y, -z, +z: a sheared box.
  void reset(const std::array<HalfSpace, 6>& box);

  /// Intersects with a half-space. True when it cut; the plane then has the next index after the
  /// box and the cuts before. Throws AnalysisError for more than most_planes.
  bool clip(const HalfSpace& plane);

  const HalfSpace& plane(std::size_t p) const { return planes_[p]; }
  std::size_t corners() const { return corners_.size(); }
  const Eigen::Vector3d& corner(std::size_t k) const { return corners_[k].position; }

  /// Area of each plane's face [d^2], by plane index; 0 for a plane with no face. Returns the
  /// volume [d^3].
  double measure(std::vector<double>& areas);

 private:
  using Triple = std::array<std::uint16_t, 3>;
  struct Corner {
    Eigen::Vector3d position;
    double error;  // bound on the distance from the true one
    Triple planes;
  };

  void add_corner(Triple planes);
  bool is_outside(const Corner& corner, const HalfSpace& plane) const;
  std::size_t pair(std::uint16_t a, std::uint16_t b) const { return a * stride_ + b; }
  void grow_tables();

  std::vector<HalfSpace> planes_;
  std::vector<Corner> corners_;

  std::vector<std::uint16_t> cut_;
  std::vector<Triple> fresh_;
  std::size_t stride_ = 0;            // planes that the tables have room for
  std::vector<std::uint8_t> marked_;  // by ordered pair of planes; all zero between calls
  std::vector<std::uint16_t> owner_;  // by ordered pair of planes: the corner on that edge's side
};

}  // namespace shearcell
