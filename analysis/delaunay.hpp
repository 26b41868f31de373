// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's Delaunay triangulation of the sites and of their images in z, and what its dual needs:
// circumcentres, the faces around edges, and the neighbours of a site.
#pragma once

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shearcell {

/// One image of a site: its position is that of the site, plus `image` periods in z.
struct SiteImage {
  std::int32_t site = -1;
  std::int32_t image = 0;
};

/// Throws an AnalysisError that names two sites as grains (the first `grains` of them) or else as
/// wall grains.
[[noreturn]] void throw_same_place(std::int32_t a, std::int32_t b, std::int32_t grains);

/// The Voronoi face between two sites.
struct DualFace {
  SiteImage a;
  SiteImage b;
  double area;  ///< [d^2]
};

/// Circumscribed sphere of a tetrahedron.
struct Sphere {
  Eigen::Vector3d centre;
  double radius_squared;
};

/// Sites closer than this count as one [d].
inline constexpr double same_place = 1e-10;

/// Predicates are exact, so the triangulation is the true one of the positions as they are stored,
/// however many of them share a plane or a sphere, and no finite tetrahedron is flat. Circumcentres
/// are computed in doubles where a forward error bound allows, and else in exact arithmetic. So
/// tetrahedra on one sphere have one centre, and the faces between them have area 0 up to rounding.
class Delaunay {
 public:
  /// Triangulates `sites` (3 x n [d], finite, z in [0, depth)), the first `grains` of which are
  /// grains, with all images whose z is within `margin` of that range. `sites` must outlive this.
  /// Throws AnalysisError, naming both, when two sites have the same position.
  Delaunay(const Eigen::Matrix3Xd& sites, std::int32_t grains, double depth, double margin);

  /// Adds the images that a wider margin asks for.
  void widen(double margin);

  double margin() const { return margin_; }

  /// False when all positions lie in one plane: there is then no tetrahedron to visit.
  bool solid() const { return triangulation_.dimension() == 3; }

  /// Computes the sphere of every tetrahedron that has a grain (no image) among its vertices, and
  /// calls visit(sites, sphere): the vertices that are sites (no images), else -1, and the sphere,
  /// null for a tetrahedron with a vertex at infinity.
  template <typename Visit>
  void visit_tetrahedra(Visit&& visit);

  /// The faces around the sites (no images) with `wanted[site] != 0`, each once. Needs
  /// visit_tetrahedra() before, and every tetrahedron at those sites bounded. Throws AnalysisError,
  /// naming both, when two sites are closer than `same_place`.
  std::vector<DualFace> faces(const std::vector<std::uint8_t>& wanted);

  /// Sites whose cells border on that of `site`, in no particular order.
  void neighbours(std::int32_t site, std::vector<SiteImage>& found) const;

  /// From one image of a site to another [d].
  Eigen::Vector3d offset(SiteImage from, SiteImage to) const {
    Eigen::Vector3d r = sites_.col(to.site) - sites_.col(from.site);
    r.z() += static_cast<double>(to.image - from.image) * depth_;
    return r;
  }

 private:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<SiteImage, Kernel>;
  // A 32-bit index fits into the padding of CGAL's cell, centres would not: the triangulation
  // takes a tenth less time so.
  using CellBase =
      CGAL::Triangulation_cell_base_with_info_3<std::uint32_t, Kernel,
                                                CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
  using Triangulation =
      CGAL::Delaunay_triangulation_3<Kernel,
                                     CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
  using CellHandle = Triangulation::Cell_handle;
  using VertexHandle = Triangulation::Vertex_handle;

  static Eigen::Vector3d vector(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }
  void collect_images(double inner, double outer, std::vector<SiteImage>& images) const;
  void insert(const std::vector<SiteImage>& images);
  Sphere circumsphere(CellHandle tetrahedron) const;
  double face_area(CellHandle start, VertexHandle a, VertexHandle b);

  const Eigen::Matrix3Xd& sites_;
  std::int32_t grains_;
  double depth_;
  double margin_;
  Triangulation triangulation_;
  std::vector<VertexHandle> vertex_;      // of each site
  std::vector<Eigen::Vector3d> centre_;   // by a tetrahedron's index
  std::vector<std::uint8_t> edges_done_;  // likewise; one bit for each edge
};

template <typename Visit>
void Delaunay::visit_tetrahedra(Visit&& visit) {
  centre_.resize(triangulation_.tds().number_of_cells());
  std::uint32_t index = 0;
  for (CellHandle cell : triangulation_.all_cell_handles()) {
    cell->info() = index++;
    std::array<std::int32_t, 4> site;
    bool any_grain = false;
    for (int k = 0; k < 4; ++k) {
      const SiteImage& vertex = cell->vertex(k)->info();  // site -1 for the vertex at infinity
      const std::int32_t s = vertex.image == 0 ? vertex.site : -1;
      any_grain = any_grain || (s >= 0 && s < grains_);
      site[static_cast<std::size_t>(k)] = s;
    }
    if (!any_grain) continue;
    if (triangulation_.is_infinite(cell)) {
      visit(site, static_cast<const Sphere*>(nullptr));
      continue;
    }
    const Sphere sphere = circumsphere(cell);
    centre_[cell->info()] = sphere.centre;
    visit(site, &sphere);
  }
}

}  // namespace shearcell
