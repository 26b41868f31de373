// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's Delaunay triangulation of the sites and of their images in z, with the circumcentres, the
// Voronoi faces between sites, and the neighbours of a site.
#pragma once

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <Eigen/Core>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace shearcell {

/// A site moved by a whole number of periods in z; image 0 is the site itself.
struct SiteImage {
  std::int32_t site;
  std::int32_t image;

  auto operator<=>(const SiteImage&) const = default;
};

/// One cache line, since walks around edges visit tetrahedra in no order.
struct alignas(64) Tetrahedron {
  std::array<std::int32_t, 4> vertex;     ///< below the number of sites: that site; -1: at infinity
  std::array<std::int32_t, 4> neighbour;  ///< across the face opposite to each vertex
  Eigen::Vector3d centre;                 ///< of its sphere, if bounded and one vertex is a grain
  std::uint8_t edges_done;                ///< one bit for each edge

  bool bounded() const {
    return vertex[0] >= 0 && vertex[1] >= 0 && vertex[2] >= 0 && vertex[3] >= 0;
  }
};

/// The Voronoi face between two sites.
struct DualFace {
  SiteImage a;
  SiteImage b;
  double area;  ///< [d^2]
};

/// Sites closer than this count as one [d].
inline constexpr double coincidence_distance = 1e-10;

/// Throws an AnalysisError that names two sites as grains (the first `grains` of them) or else as
/// wall grains.
[[noreturn]] void throw_same_place(std::int32_t a, std::int32_t b, std::int32_t grains);

/// Predicates are exact, so this is the true triangulation of the positions as they are stored,
/// however many of them share a plane or a sphere, and no bounded tetrahedron is flat.
/// Circumcentres are computed in doubles where a forward error bound allows, and else in exact
/// arithmetic. So tetrahedra on one sphere have one centre, and the faces between them no area but
/// rounding.
class Delaunay {
 public:
  /// Triangulates `sites` (3 x n [d], finite, z in [0, depth)), the first `grains` of which are
  /// grains, with all images whose z is within `margin` of that range. `sites` must outlive this.
  /// Throws AnalysisError, naming both, when two sites have the same position.
  Delaunay(const Eigen::Matrix3Xd& sites, std::int32_t grains, double depth, double margin);

  /// Adds the images that a wider margin asks for.
  void widen(double margin);

  double margin() const { return margin_; }

  /// All tetrahedra; none when all positions lie in one plane.
  std::span<const Tetrahedron> tetrahedra() const { return tetrahedra_; }

  const Eigen::Vector3d& point(std::int32_t vertex) const {
    return point_[static_cast<std::size_t>(vertex)];
  }

  /// The faces around the sites (no images) with `wanted[site] != 0`, each once. Every tetrahedron
  /// at those sites must be bounded. Throws AnalysisError, naming both, when two sites are closer
  /// than `coincidence_distance`.
  std::vector<DualFace> faces(const std::vector<std::uint8_t>& wanted);

  /// Sites whose cells border on that of `site`, in no particular order.
  std::vector<SiteImage> neighbours(std::int32_t site) const;

  /// From a site to an image of another [d].
  Eigen::Vector3d offset(std::int32_t from, SiteImage to) const {
    Eigen::Vector3d r = sites_.col(to.site) - sites_.col(from);
    r.z() += to.image * depth_;
    return r;
  }

 private:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  struct Number {
    std::int32_t value = -1;
  };
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<Number, Kernel>;
  // A number fits into the padding of CGAL's cell; a centre would not. The smaller cells take a
  // tenth less time.
  using CellBase =
      CGAL::Triangulation_cell_base_with_info_3<Number, Kernel,
                                                CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
  using Triangulation =
      CGAL::Delaunay_triangulation_3<Kernel,
                                     CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

  void add_point(SiteImage image);
  void insert_points();
  void copy_tetrahedra();
  Eigen::Vector3d circumcentre(const std::array<std::int32_t, 4>& vertices) const;
  double face_area(std::int32_t start, std::size_t i, std::size_t j);

  const Eigen::Matrix3Xd& sites_;
  std::int32_t grains_;
  double depth_;
  double margin_ = 0;
  Triangulation triangulation_;
  // By vertex: the sites, then images.
  std::vector<SiteImage> image_;
  std::vector<Eigen::Vector3d> point_;
  std::vector<Triangulation::Vertex_handle> handle_;  // as many as are in the triangulation
  std::vector<Tetrahedron> tetrahedra_;
};

}  // namespace shearcell
