// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/voronoi.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <map>
#include <utility>

#include "provenance/errors.hpp"

namespace shearcell {
namespace {

constexpr double smallest_face = 1e-13;         // [d^2]
constexpr double coincidence_distance = 1e-10;  // closer sites coincide [d]
// Images within this margin suffice in a dense packing. Other packings need a second pass.
constexpr double first_margin_spacings = 2.1;
// Largest error allowed for a circumcentre computed in doubles, relative to the larger of 1 d and
// the circumradius. If the error may be larger, the circumcentre is computed in exact arithmetic.
constexpr double worst_centre_error = 1e-12;

/// A site shifted by a whole number of periods in z. Image 0 is the site itself.
struct SiteImage {
  std::int32_t site;  // -1 for a guard (see Tessellation)
  std::int32_t image;

  auto operator<=>(const SiteImage&) const = default;
};

/// Aligned to a cache line, since walks around edges access tetrahedra in irregular order.
struct alignas(64) Tetrahedron {
  std::array<std::int32_t, 4> vertex;     // index of each corner in point_; -1: at infinity
  std::array<std::int32_t, 4> neighbour;  // tetrahedron opposite to each corner
  Eigen::Vector3d centre;   // circumcentre; set only if at least one corner is a grain
  std::uint8_t beyond;      // bit w is 1: the centre is on or beyond wall w
  std::uint8_t edges_done;  // a bit for each edge: 1 if the face between its two sites is measured
};

constexpr std::array<std::array<std::uint8_t, 2>, 6> edges = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
constexpr std::array<std::array<std::uint8_t, 4>, 4> edge_bit = {
    {{0, 1, 2, 4}, {1, 0, 8, 16}, {2, 8, 0, 32}, {4, 16, 32, 0}}};

/// Index (0 to 3) of the corner of t at `vertex`, which must be a vertex of t.
std::size_t corner_of(const Tetrahedron& t, std::int32_t vertex) {
  return (t.vertex[1] == vertex ? 1U : 0U) + (t.vertex[2] == vertex ? 2U : 0U) +
         (t.vertex[3] == vertex ? 3U : 0U);
}

/// Computes the Voronoi cells of the grains from a Delaunay triangulation. The grains are the first
/// `grains` sites.
///
/// CGAL's predicates are exact. The triangulation is therefore correct for the stored positions,
/// even if many sites share a plane or a sphere. No bounded tetrahedron is flat. Circumcentres
/// are computed in doubles if an error bound allows it, otherwise in exact arithmetic. Tetrahedra
/// with the same circumsphere thus have the same centre, and faces between them have no area except
/// for rounding errors.
///
/// A face is the polygon of the circumcentres around an edge, clipped by the walls. All faces that
/// meet in a circumcentre use the same coordinates for the circumcentre. They also agree on whether
/// the circumcentre lies beyond a wall. So the cells fit together without gaps.
///
/// The guards are eight additional points at the corners of a large cube, so that every cell is
/// bounded. They are farther away in z than any periodic image that a cell may need. So no cell
/// that passes the test in measure() borders on a guard.
class Tessellation {
 public:
  Tessellation(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites,
               std::int32_t grains)
      : cell_(cell), walls_(wall_planes(cell, pose)), sites_(sites), grains_(grains) {
    const double height = pose.top - pose.bottom;
    for (std::int32_t i = 0; i < sites.cols(); ++i) add_point({i, 0});
    const Eigen::Vector3d centre(cell.width / 2, pose.top - height / 2, cell.depth / 2);
    double size = cell.width + height * (1 + std::abs(pose.tan_theta)) + cell.depth;
    for (const auto& site : sites.colwise()) {
      size = std::max(size, 2 * (site - centre).lpNorm<1>());
    }
    for (unsigned k = 0; k < 8; ++k) {
      const Eigen::Vector3d corner((k & 1U) != 0 ? 1 : -1, (k & 2U) != 0 ? 1 : -1,
                                   (k & 4U) != 0 ? 1 : -1);
      image_.push_back({-1, 0});
      point_.emplace_back(centre + 4 * size * corner);
    }
    const double spacing = std::cbrt(cell.width * cell.depth * height /
                                     std::max(static_cast<double>(sites.cols()), 1.0));
    widen(first_margin_spacings * spacing);
  }

  /// The margin is the distance in z, beyond [0, depth], up to which periodic images were added.
  /// Each corner of a cell is the centre of a sphere through the cell's site. The reach is the
  /// largest distance in z by which these spheres extend beyond [0, depth]. All cells are correct
  /// if the reach is at most the margin. More images can only make cells smaller, so a margin as
  /// large as the present reach is sufficient. While images are missing, a cell can border on a
  /// guard (see Tessellation). The reach is then much too large. Therefore each pass at most
  /// doubles the margin.
  VoronoiDiagram measure() {
    while (true) {
      reach_ = 0;
      copy_tetrahedra();
      measure_faces();
      if (reach_ <= margin_) return collect();
      widen(std::min((1 + 1e-9) * reach_, 2 * margin_));
    }
  }

 private:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  struct Number {
    std::int32_t value = -1;
  };
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<Number, Kernel>;
  // CGAL's tetrahedra store only a number, which fits into their padding. If they also stored the
  // circumcentre, the computation would take 10 % longer.
  using CellBase =
      CGAL::Triangulation_cell_base_with_info_3<Number, Kernel,
                                                CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
  using Triangulation =
      CGAL::Delaunay_triangulation_3<Kernel,
                                     CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

  /// A face as seen from one of its two sites.
  struct Side {
    SiteImage to;
    double area;
  };

  /// A corner of a polygon, and the wall on which the side to the next corner lies.
  struct Corner {
    Eigen::Vector3d at;
    std::size_t wall;
  };
  static constexpr std::size_t no_wall = 4;

  const Eigen::Vector3d& point(std::int32_t vertex) const {
    return point_[static_cast<std::size_t>(vertex)];
  }

  /// Adds each periodic image of a site if the image is outside [0, depth) in z by less than
  /// `margin`.
  void widen(double margin) {
    const auto is_new = [&](double distance) { return distance >= margin_ && distance < margin; };
    for (std::int32_t k = 1; (k - 1) * cell_.depth < margin; ++k) {
      for (std::int32_t i = 0; i < sites_.cols(); ++i) {
        if (is_new(sites_(2, i) + (k - 1) * cell_.depth)) add_point({i, k});
        if (is_new(k * cell_.depth - sites_(2, i))) add_point({i, -k});
      }
    }
    margin_ = margin;
    insert_points();
  }

  void add_point(SiteImage image) {
    image_.push_back(image);
    point_.push_back(sites_.col(image.site));
    point_.back().z() += image.image * cell_.depth;
  }

  void insert_points() {
    std::vector<std::pair<Kernel::Point_3, Number>> points;
    for (std::size_t k = inserted_; k < point_.size(); ++k) {
      const Eigen::Vector3d& p = point_[k];
      points.push_back({{p.x(), p.y(), p.z()}, {static_cast<std::int32_t>(k)}});
    }
    triangulation_.insert(points.begin(), points.end());
    inserted_ = point_.size();
    if (triangulation_.number_of_vertices() == inserted_) return;
    std::map<std::array<double, 3>, std::int32_t> known;
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(inserted_); ++k) {
      const Eigen::Vector3d& p = point(k);
      const auto [same, fresh] = known.try_emplace({p.x(), p.y(), p.z()}, k);
      if (!fresh) throw_same_place(same->second, k);
    }
  }

  [[noreturn]] void throw_same_place(std::int32_t a, std::int32_t b) const {
    const auto name = [&](std::int32_t site) {
      return site < grains_ ? fmt::format("grain {}", site)
                            : fmt::format("wall grain {}", site - grains_);
    };
    const auto [first, second] = std::minmax(image_[static_cast<std::size_t>(a)].site,
                                             image_[static_cast<std::size_t>(b)].site);
    throw AnalysisError(fmt::format("{} and {} lie at the same place", name(first), name(second)));
  }

  bool is_grain(std::int32_t vertex) const { return vertex >= 0 && vertex < grains_; }

  void copy_tetrahedra() {
    std::int32_t count = 0;
    for (const auto cell : triangulation_.all_cell_handles()) cell->info().value = count++;
    tetrahedra_.resize(static_cast<std::size_t>(count));
    auto copy = tetrahedra_.begin();
    for (const auto cell : triangulation_.all_cell_handles()) {
      bool any_grain = false;
      for (int k = 0; k < 4; ++k) {
        const std::int32_t vertex = cell->vertex(k)->info().value;
        any_grain = any_grain || is_grain(vertex);
        copy->vertex[static_cast<std::size_t>(k)] = vertex;
        copy->neighbour[static_cast<std::size_t>(k)] = cell->neighbor(k)->info().value;
      }
      copy->edges_done = 0;
      copy->beyond = 0;
      if (any_grain) {
        copy->centre = circumcentre(copy->vertex);
        for (std::size_t wall = 0; wall < 4; ++wall) {
          if (!(distance_to(wall, copy->centre) > 0)) {
            copy->beyond = static_cast<std::uint8_t>(copy->beyond | (1U << wall));
          }
        }
        if (copy->beyond == 0) note_reach(copy->centre, copy->vertex[0]);
      }
      ++copy;
    }
  }

  Eigen::Vector3d circumcentre(std::array<std::int32_t, 4> vertices) const {
    // The vectors a, b and c start at a grain. If they started at a guard, all three would be long.
    if (!is_grain(vertices[0])) {
      std::iter_swap(vertices.begin(), std::ranges::find_if(vertices, [&](std::int32_t vertex) {
                       return is_grain(vertex);
                     }));
    }
    const Eigen::Vector3d origin = point(vertices[0]);
    const Eigen::Vector3d a = point(vertices[1]) - origin;
    const Eigen::Vector3d b = point(vertices[2]) - origin;
    const Eigen::Vector3d c = point(vertices[3]) - origin;
    const Eigen::Vector3d bc = b.cross(c);
    const double aa = a.squaredNorm();
    const double bb = b.squaredNorm();
    const double cc = c.squaredNorm();
    const double determinant = a.dot(bc);
    const Eigen::Vector3d v = (aa * bc + bb * c.cross(a) + cc * a.cross(b)) / (2 * determinant);

    // Forward error of Cramer's rule. A count of the operations shows that the errors of numerator
    // and determinant are below 32 roundoffs times the sum of the magnitudes of their terms.
    constexpr double roundoff = std::numeric_limits<double>::epsilon() / 2;
    const double radius = v.norm();
    const double la = std::sqrt(aa);
    const double lb = std::sqrt(bb);
    const double lc = std::sqrt(cc);
    const double terms = la * lb * lc * ((la + lb + lc) / 2 + radius);
    const double allowed = worst_centre_error * std::max(1.0, radius);
    if (32 * roundoff * terms < allowed * std::abs(determinant)) return origin + v;

    using Rational = CGAL::Simple_cartesian<CGAL::Exact_rational>;
    const auto exact = [&](std::size_t k) {
      const Eigen::Vector3d& p = point(vertices[k]);
      return Rational::Point_3(p.x(), p.y(), p.z());
    };
    const Rational::Point_3 centre = CGAL::circumcenter(exact(0), exact(1), exact(2), exact(3));
    return {CGAL::to_double(centre.x()), CGAL::to_double(centre.y()), CGAL::to_double(centre.z())};
  }

  double distance_to(std::size_t wall, const Eigen::Vector3d& p) const {
    return shearcell::distance_to(walls_[wall], p.x(), p.y());
  }

  Eigen::Vector3d outwards(std::size_t wall) const {
    return {-walls_[wall].normal[0], -walls_[wall].normal[1], 0};
  }

  /// Updates reach_ with the sphere that has its centre at `corner` and passes through the site.
  void note_reach(const Eigen::Vector3d& corner, std::int32_t vertex) {
    const double radius = (corner - point(vertex)).norm();
    reach_ = std::max({reach_, corner.z() + radius - cell_.depth, radius - corner.z()});
  }

  void measure_faces() {
    sides_.assign(static_cast<std::size_t>(grains_), {});
    for (std::vector<Side>& sides : sides_) sides.reserve(20);  // few grains have more neighbours
    wall_area_.assign(static_cast<std::size_t>(grains_), {0, 0, 0, 0});
    for (std::size_t k = 0; k < tetrahedra_.size(); ++k) {
      const Tetrahedron& t = tetrahedra_[k];
      for (const auto [i, j] : edges) {
        if ((t.edges_done & edge_bit[i][j]) != 0) continue;
        if (is_grain(t.vertex[i]) || is_grain(t.vertex[j])) measure_face(k, i, j);
      }
    }
  }

  /// Measures the face between the sites at corners i and j of tetrahedron `start`.
  void measure_face(std::size_t start, std::size_t i, std::size_t j) {
    const std::int32_t a = tetrahedra_[start].vertex[i];
    const std::int32_t b = tetrahedra_[start].vertex[j];
    const Eigen::Vector3d edge = point(b) - point(a);
    const double length = edge.norm();
    if (length < coincidence_distance) throw_same_place(a, b);

    Eigen::Vector3d twice = Eigen::Vector3d::Zero();
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();
    unsigned beyond = 0;
    walk_around(start, a, b, [&](Tetrahedron& t, std::uint8_t bit) {
      t.edges_done = static_cast<std::uint8_t>(t.edges_done | bit);
      beyond |= t.beyond;
      const Eigen::Vector3d next = t.centre - tetrahedra_[start].centre;
      twice += arm.cross(next);
      arm = next;
    });
    if (beyond != 0) twice = clip(start, a, b, beyond);
    const double area = edge.dot(twice) / (2 * length);
    if (area <= smallest_face) return;
    const auto note = [&](std::int32_t from, std::int32_t to) {
      if (!is_grain(from)) return;
      sides_[static_cast<std::size_t>(from)].push_back(
          {image_[static_cast<std::size_t>(to)], area});
    };
    note(a, b);
    note(b, a);
  }

  /// Calls visit(tetrahedron, bit) for each tetrahedron around the edge from a to b. `bit` marks
  /// this edge among the six edges of the tetrahedron.
  template <class Visit>
  void walk_around(std::size_t start, std::int32_t a, std::int32_t b, const Visit& visit) {
    std::size_t k = start;
    do {
      Tetrahedron& t = tetrahedra_[k];
      const std::size_t i = corner_of(t, a);
      const std::size_t j = corner_of(t, b);
      visit(t, edge_bit[i][j]);
      const int across = Triangulation::next_around_edge(static_cast<int>(i), static_cast<int>(j));
      k = static_cast<std::size_t>(t.neighbour[static_cast<std::size_t>(across)]);
    } while (k != start);
  }

  /// Clips the face between a and b at the walls in `beyond`. Returns twice the vector area of the
  /// remaining polygon. A side of this polygon that lies on a wall also borders two wall faces,
  /// which belong to the cells of a and b. The side contributes to the areas of both wall faces:
  /// the area of a wall face is the integral of -z du along its border, where u and z are
  /// perpendicular coordinates in the wall plane. Borders along an edge of the box contribute
  /// nothing, because du is 0 there.
  Eigen::Vector3d clip(std::size_t start, std::int32_t a, std::int32_t b, unsigned beyond) {
    polygon_.clear();
    walk_around(start, a, b, [&](const Tetrahedron& t, std::uint8_t) {
      polygon_.push_back({t.centre, no_wall});
    });
    for (std::size_t wall = 0; wall < 4; ++wall) {
      if ((beyond & (1U << wall)) != 0) clip(wall);
    }
    Eigen::Vector3d twice = Eigen::Vector3d::Zero();
    for_each_side(polygon_, [&](const Corner& p, const Corner& q) {
      note_reach(p.at, a);
      twice += (p.at - polygon_[0].at).cross(q.at - polygon_[0].at);
      if (p.wall == no_wall) return;
      const double du = (q.at - p.at).dot(Eigen::Vector3d::UnitZ().cross(outwards(p.wall)));
      const double z = (p.at.z() + q.at.z()) / 2;
      const auto note = [&](std::int32_t from, double area) {
        if (is_grain(from)) wall_area_[static_cast<std::size_t>(from)][p.wall] += area;
      };
      note(a, (z - point(a).z()) * du);
      note(b, (point(b).z() - z) * du);
    });
    return twice;
  }

  /// Clips polygon_ at a wall (Sutherland and Hodgman, Commun. ACM 17, 32 (1974)).
  void clip(std::size_t wall) {
    clipped_.clear();
    for_each_side(polygon_, [&](const Corner& p, const Corner& q) {
      const double to_p = distance_to(wall, p.at);
      const double to_q = distance_to(wall, q.at);
      if (to_p > 0) clipped_.push_back(p);
      if ((to_p > 0) == (to_q > 0)) return;
      const Eigen::Vector3d crossing = p.at + to_p / (to_p - to_q) * (q.at - p.at);
      clipped_.push_back({crossing, to_p > 0 ? wall : p.wall});
    });
    polygon_.swap(clipped_);
  }

  template <class Visit>
  static void for_each_side(const std::vector<Corner>& polygon, const Visit& visit) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      visit(polygon[k], polygon[k + 1 < polygon.size() ? k + 1 : 0]);
    }
  }

  VoronoiDiagram collect() {
    VoronoiDiagram diagram;
    diagram.faces.reserve(
        16 * static_cast<std::size_t>(grains_));  // a dense packing has slightly fewer faces
    diagram.first.push_back(0);
    for (std::int32_t i = 0; i < grains_; ++i) {
      double volume = 0, surface = 0;
      const auto add = [&](const VoronoiFace& face, double pyramid) {
        diagram.faces.push_back(face);
        volume += pyramid;
        surface += face.area;
      };
      std::vector<Side>& sides = sides_[static_cast<std::size_t>(i)];
      std::ranges::sort(sides, {}, &Side::to);
      for (const auto& [to, area] : sides) {
        const bool grain = to.site < grains_;
        Eigen::Vector3d offset = sites_.col(to.site) - sites_.col(i);
        offset.z() += to.image * cell_.depth;
        add({offset, area, grain ? to.site : to.site - grains_,
             grain ? NeighbourKind::grain : NeighbourKind::wall_grain},
            area * offset.norm() / 6);
      }
      for (std::size_t wall = 0; wall < 4; ++wall) {
        const double area = wall_area_[static_cast<std::size_t>(i)][wall];
        if (area <= smallest_face) continue;
        const double distance = distance_to(wall, sites_.col(i));
        add({2 * distance * outwards(wall), area, static_cast<std::int32_t>(wall),
             NeighbourKind::wall_plane},
            area * distance / 3);
      }
      diagram.volume.push_back(volume);
      diagram.surface.push_back(surface);
      diagram.first.push_back(diagram.faces.size());
    }
    return diagram;
  }

  const Cell& cell_;
  std::array<WallPlane, 4> walls_;
  const Eigen::Matrix3Xd& sites_;
  std::int32_t grains_;
  double margin_ = 0;
  Triangulation triangulation_;
  // One entry per vertex: first the sites, then the guards, then the images.
  std::vector<SiteImage> image_;
  std::vector<Eigen::Vector3d> point_;
  std::size_t inserted_ = 0;  // number of points in the triangulation
  std::vector<Tetrahedron> tetrahedra_;
  double reach_ = 0;                              // see measure() [d]
  std::vector<std::vector<Side>> sides_;          // by grain
  std::vector<std::array<double, 4>> wall_area_;  // by grain and wall
  std::vector<Corner> polygon_;                   // current face
  std::vector<Corner> clipped_;
};

void require_inside(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains) {
  for (Eigen::Index i = 0; i < grains.cols(); ++i) {
    if (!grains.col(i).allFinite()) {
      throw AnalysisError(fmt::format("grain {} has no finite position", i));
    }
    const Eigen::Vector4d distance = wall_distances(cell, pose, grains.col(i));
    Eigen::Index side = 0;
    const double least = distance.minCoeff(&side);
    if (least <= 0) {
      throw AnalysisError(fmt::format("grain {} lies outside the cell: {:f} d beyond the {} wall",
                                      i, -least, name_of(static_cast<WallSide>(side))));
    }
  }
}

}  // namespace

Eigen::Vector4d wall_distances(const Cell& cell, const WallPose& pose,
                               const Eigen::Vector3d& point) {
  const double untilted = point.x() - (point.y() - pose.top) * pose.tan_theta;
  return {untilted * pose.cos_theta, (cell.width - untilted) * pose.cos_theta,
          point.y() - pose.bottom, pose.top - point.y()};
}

Eigen::Matrix3Xd wrapped_sites(const Cell& cell, const WallPose& pose,
                               const Eigen::Matrix3Xd& grains) {
  Eigen::Matrix3Xd sites(3, grains.cols() + static_cast<Eigen::Index>(cell.wall_grains.size()));
  sites << grains, wall_grain_positions(cell, pose);
  for (Eigen::Index i = 0; i < sites.cols(); ++i) {
    double& z = sites(2, i);
    z -= cell.depth * std::floor(z / cell.depth);
    if (z >= cell.depth) z = 0;  // if z was tiny and negative, z + depth is rounded to depth
  }
  return sites;
}

VoronoiDiagram voronoi(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains) {
  if (!(cell.width > 0 && cell.depth > 0 && pose.top > pose.bottom)) {
    throw AnalysisError("the cell has no volume");
  }
  require_inside(cell, pose, grains);
  const Eigen::Matrix3Xd sites = wrapped_sites(cell, pose, grains);
  if (!sites.allFinite()) throw AnalysisError("a wall grain has no finite position");
  return Tessellation(cell, pose, sites, static_cast<std::int32_t>(grains.cols())).measure();
}

}  // namespace shearcell
