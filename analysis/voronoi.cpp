// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/voronoi.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "analysis/clip.hpp"
#include "analysis/delaunay.hpp"
#include "analysis/error.hpp"

namespace shearcell {
namespace {

constexpr double smallest_face = 1e-13;  // [d^2]
// In a dense packing, images farther away touch no cell. Other packings need a second pass.
constexpr double first_margin_spacings = 2.1;

constexpr std::array<const char*, 4> side_names = {"left", "right", "bottom", "top"};

/// The diagram of one packing from its triangulation.
class Dual {
 public:
  Dual(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& sites, std::int32_t grains)
      : cell_(cell),
        pose_(pose),
        sites_(sites),
        grains_(grains),
        delaunay_(sites, grains, cell.depth, first_margin_spacings * spacing()) {}

  /// Measures all cells. A cell is right if the sphere around each of its corners, through the
  /// site, lies within the margin. More images can only make cells smaller, so the reach of the
  /// first pass is enough for the second.
  VoronoiDiagram measure(WallGrainCells wall_grain_cells) {
    while (true) {
      reach_ = 0;
      VoronoiDiagram diagram = measure_all(wall_grain_cells);
      if (reach_ <= delaunay_.margin()) return diagram;
      delaunay_.widen((1 + 1e-9) * reach_);
    }
  }

 private:
  /// A face as seen from one of its grains.
  struct Side {
    SiteImage to;
    double area;
  };

  VoronoiDiagram measure_all(WallGrainCells wall_grain_cells) {
    find_bulk();
    collect_sides();
    VoronoiDiagram diagram;
    const auto count = static_cast<std::size_t>(grains_);
    diagram.volume.reserve(count);
    diagram.surface.reserve(count);
    diagram.first.reserve(count + 1);
    diagram.faces.reserve(16 * count);  // a little more than a dense packing has
    diagram.first.push_back(0);
    for (std::int32_t i = 0; i < grains_; ++i) {
      if (bulk_[static_cast<std::size_t>(i)] != 0) {
        measure_bulk(i, diagram);
      } else {
        measure_clipped(i, diagram);
      }
      diagram.first.push_back(diagram.faces.size());
    }
    if (wall_grain_cells == WallGrainCells::measure) {
      for (auto w = grains_; w < sites_.cols(); ++w) {
        diagram.wall_grain_volume.push_back(clip(w));
      }
    }
    return diagram;
  }

  double spacing() const {
    const double volume = cell_.width * cell_.depth * (pose_.top - pose_.bottom);
    return std::cbrt(volume / std::max(static_cast<double>(sites_.cols()), 1.0));
  }

  void note_reach(double z, double radius) {
    reach_ = std::max({reach_, z + radius - cell_.depth, radius - z});
  }

  /// Whether a cell's corner may be here: inside the walls, and within the distance in z at which a
  /// grain's own images bound its cell. With too few images, spheres may be centred anywhere.
  bool may_be_corner(const Eigen::Vector3d& centre) const {
    return std::abs(centre.z() - cell_.depth / 2) <= cell_.depth &&
           wall_distances(cell_, pose_, centre).minCoeff() >= 0;
  }

  void find_bulk() {
    bulk_.assign(static_cast<std::size_t>(sites_.cols()), 0);
    if (!delaunay_.tetrahedra().empty()) std::fill_n(bulk_.begin(), grains_, std::uint8_t{1});
    const auto is_grain = [&](std::int32_t vertex) { return vertex >= 0 && vertex < grains_; };
    for (const Tetrahedron& t : delaunay_.tetrahedra()) {
      if (std::none_of(t.vertex.begin(), t.vertex.end(), is_grain)) continue;
      if (t.bounded() && may_be_corner(t.centre)) {
        note_reach(t.centre.z(), (t.centre - delaunay_.point(t.vertex[0])).norm());
        continue;
      }
      for (const std::int32_t vertex : t.vertex) {
        if (is_grain(vertex)) bulk_[static_cast<std::size_t>(vertex)] = 0;
      }
    }
  }

  void collect_sides() {
    sides_.assign(static_cast<std::size_t>(grains_), {});
    const auto note = [&](const SiteImage& from, const SiteImage& to, double area) {
      const auto grain = static_cast<std::size_t>(from.site);
      if (from.image != 0 || bulk_[grain] == 0) return;
      if (sides_[grain].empty()) sides_[grain].reserve(20);  // few grains have more neighbours
      sides_[grain].push_back({to, area});
    };
    for (const DualFace& face : delaunay_.faces(bulk_)) {
      note(face.a, face.b, face.area);
      note(face.b, face.a, face.area);
    }
  }

  void measure_bulk(std::int32_t site, VoronoiDiagram& diagram) {
    std::vector<Side>& sides = sides_[static_cast<std::size_t>(site)];
    std::ranges::sort(sides, {}, &Side::to);
    double surface = 0;
    double volume = 0;
    for (const Side& side : sides) {
      if (side.area <= smallest_face) continue;
      diagram.faces.push_back(face_to(site, side.to, side.area));
      surface += side.area;
      volume += side.area * diagram.faces.back().to_neighbour.norm() / 6;
    }
    diagram.volume.push_back(volume);
    diagram.surface.push_back(surface);
  }

  std::array<HalfSpace, 6> box_around(const Eigen::Vector3d& point) const {
    const Eigen::Vector4d distance = wall_distances(cell_, pose_, point);
    const double c = pose_.cos_theta;
    const double s = pose_.sin_theta;
    const Eigen::Vector3d period(0, 0, cell_.depth);
    return {plane_at({-c, s, 0}, distance[0]),
            plane_at({c, -s, 0}, distance[1]),
            plane_at({0, -1, 0}, distance[2]),
            plane_at({0, 1, 0}, distance[3]),
            bisector_to(-period),
            bisector_to(period)};
  }

  /// Cuts the box by the bisectors to the neighbours and leaves the cell in polyhedron_ and areas_.
  /// Returns its volume [d^3].
  double clip(std::int32_t site) {
    // Near ones first, so that most later planes do not cut. The order is unique.
    std::vector<std::pair<double, SiteImage>> ranks;
    for (const SiteImage& other : delaunay_.neighbours(site)) {
      ranks.emplace_back(delaunay_.offset(site, other).squaredNorm(), other);
    }
    std::ranges::sort(ranks);

    polyhedron_.reset(box_around(sites_.col(site)));
    plane_site_.clear();
    for (const auto& [distance2, other] : ranks) {
      if (distance2 < coincidence_distance * coincidence_distance)
        throw_same_place(site, other.site, grains_);
      if (other.site == site && std::abs(other.image) == 1) continue;  // a plane of the box already
      if (polyhedron_.clip(bisector_to(delaunay_.offset(site, other))))
        plane_site_.push_back(other);
    }
    for (std::size_t k = 0; k < polyhedron_.corners(); ++k) {
      const Eigen::Vector3d corner = polyhedron_.corner(k);
      note_reach(sites_(2, site) + corner.z(), corner.norm());
    }
    return polyhedron_.measure(areas_);
  }

  void measure_clipped(std::int32_t site, VoronoiDiagram& diagram) {
    diagram.volume.push_back(clip(site));
    const std::size_t begin = diagram.faces.size();
    double surface = 0;
    for (std::size_t plane = 0; plane < areas_.size(); ++plane) {
      const double area = areas_[plane];
      if (area <= smallest_face) continue;
      surface += area;
      if (plane < 4) {
        const HalfSpace& wall = polyhedron_.plane(plane);
        diagram.faces.push_back({2 * wall.offset * wall.normal, area,
                                 static_cast<std::int32_t>(plane), NeighbourKind::wall_plane});
      } else if (plane < 6) {
        diagram.faces.push_back(face_to(site, {site, plane == 4 ? -1 : 1}, area));
      } else {
        diagram.faces.push_back(face_to(site, plane_site_[plane - 6], area));
      }
    }
    diagram.surface.push_back(surface);
    std::ranges::sort(std::span(diagram.faces).subspan(begin), {}, [](const VoronoiFace& face) {
      return std::tuple(face.kind, face.neighbour, face.to_neighbour.z());
    });
  }

  VoronoiFace face_to(std::int32_t site, SiteImage other, double area) const {
    const bool grain = other.site < grains_;
    return {delaunay_.offset(site, other), area, grain ? other.site : other.site - grains_,
            grain ? NeighbourKind::grain : NeighbourKind::wall_grain};
  }

  const Cell& cell_;
  const WallPose& pose_;
  const Eigen::Matrix3Xd& sites_;
  std::int32_t grains_;
  Delaunay delaunay_;
  double reach_ = 0;                // of all spheres around corners, beyond the period in z [d]
  std::vector<std::uint8_t> bulk_;  // by site: a grain whose cell meets no wall plane
  std::vector<std::vector<Side>> sides_;  // by grain; of those in the bulk

  ConvexCell polyhedron_;
  std::vector<SiteImage> plane_site_;  // by plane index - 6
  std::vector<double> areas_;
};

void require_inside(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains) {
  for (Eigen::Index i = 0; i < grains.cols(); ++i) {
    if (!grains.col(i).allFinite()) {
      throw AnalysisError("grain " + std::to_string(i) + " has no finite position");
    }
    const Eigen::Vector4d distance = wall_distances(cell, pose, grains.col(i));
    Eigen::Index side = 0;
    const double least = distance.minCoeff(&side);
    if (least <= 0) {
      throw AnalysisError("grain " + std::to_string(i) +
                          " lies outside the cell: " + std::to_string(-least) + " d beyond the " +
                          side_names[static_cast<std::size_t>(side)] + " wall");
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
    if (z >= cell.depth) z = 0;  // a tiny negative z rounds up to a whole period
  }
  return sites;
}

VoronoiDiagram voronoi(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains,
                       WallGrainCells wall_grain_cells) {
  if (!(cell.width > 0 && cell.depth > 0 && pose.top > pose.bottom)) {
    throw AnalysisError("the cell has no volume");
  }
  require_inside(cell, pose, grains);
  const Eigen::Matrix3Xd sites = wrapped_sites(cell, pose, grains);
  if (!sites.allFinite()) throw AnalysisError("a wall grain has no finite position");
  return Dual(cell, pose, sites, static_cast<std::int32_t>(grains.cols()))
      .measure(wall_grain_cells);
}

}  // namespace shearcell
