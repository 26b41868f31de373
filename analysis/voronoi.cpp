// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/voronoi.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "analysis/clip.hpp"
#include "analysis/delaunay.hpp"
#include "analysis/error.hpp"

namespace shearcell {
namespace {

constexpr double smallest_face = 1e-13;  // [d^2]
// Beyond this no image bears on a cell of a dense packing; a second pass serves all others.
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

  /// Measures all cells. More images can only make cells smaller. So the first pass bounds the
  /// margin that is needed, by spheres around the corners that hold no image, and the second pass
  /// is the last.
  VoronoiDiagram measure(WallGrainCells wall_grain_cells);

 private:
  /// A face as seen from one of its grains.
  struct Side {
    std::int32_t to;
    std::int32_t image;
    double area;
  };

  VoronoiDiagram measure_all(WallGrainCells wall_grain_cells);
  double spacing() const;
  void note_reach(double z, double radius);
  bool may_be_corner(const Eigen::Vector3d& centre) const;
  void find_bulk();
  void collect_sides();
  std::array<HalfSpace, 6> box_around(const Eigen::Vector3d& point) const;
  double clip(std::int32_t site);
  void measure_bulk(std::int32_t site, VoronoiDiagram& diagram);
  void measure_clipped(std::int32_t site, VoronoiDiagram& diagram);
  VoronoiFace face_to(std::int32_t site, SiteImage other, double area) const;

  const Cell& cell_;
  const WallPose& pose_;
  const Eigen::Matrix3Xd& sites_;
  std::int32_t grains_;
  Delaunay delaunay_;
  double reach_ = 0;                // of all spheres around corners, beyond the period in z [d]
  std::vector<std::uint8_t> bulk_;  // by site: a grain whose cell meets no wall plane
  std::vector<std::size_t> first_;  // by grain, n + 1 entries: its sides are first_[i] ..
  std::vector<Side> sides_;         // of grains in the bulk

  ConvexCell polyhedron_;
  std::vector<SiteImage> neighbours_;
  std::vector<SiteImage> plane_site_;  // by plane index - 6
  std::vector<double> areas_;
};

double Dual::spacing() const {
  const double volume = cell_.width * cell_.depth * (pose_.top - pose_.bottom);
  return std::cbrt(volume / std::max(static_cast<double>(sites_.cols()), 1.0));
}

void Dual::note_reach(double z, double radius) {
  reach_ = std::max({reach_, z + radius - cell_.depth, radius - z});
}

/// Inside the walls, and no farther out in z than a grain's own images leave room for. Where a wide
/// gap has too few images yet, spheres may be centred anywhere.
bool Dual::may_be_corner(const Eigen::Vector3d& centre) const {
  return std::abs(centre.z() - cell_.depth / 2) <= cell_.depth &&
         wall_distances(cell_, pose_, centre).minCoeff() >= 0;
}

void Dual::find_bulk() {
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

void Dual::collect_sides() {
  const std::vector<DualFace> faces = delaunay_.faces(bulk_);
  const auto seen_by = [&](const SiteImage& v) {
    return v.image == 0 && bulk_[static_cast<std::size_t>(v.site)] != 0;
  };
  first_.assign(static_cast<std::size_t>(grains_) + 1, 0);
  for (const DualFace& face : faces) {
    if (seen_by(face.a)) ++first_[static_cast<std::size_t>(face.a.site) + 1];
    if (seen_by(face.b)) ++first_[static_cast<std::size_t>(face.b.site) + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sides_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  const auto note = [&](const SiteImage& from, const SiteImage& to, double area) {
    if (!seen_by(from)) return;
    sides_[next[static_cast<std::size_t>(from.site)]++] = {to.site, to.image, area};
  };
  for (const DualFace& face : faces) {
    note(face.a, face.b, face.area);
    note(face.b, face.a, face.area);
  }
}

VoronoiFace Dual::face_to(std::int32_t site, SiteImage other, double area) const {
  const bool grain = other.site < grains_;
  return {delaunay_.offset(site, other), area, grain ? other.site : other.site - grains_,
          grain ? NeighbourKind::grain : NeighbourKind::wall_grain};
}

void Dual::measure_bulk(std::int32_t site, VoronoiDiagram& diagram) {
  const auto begin =
      sides_.begin() + static_cast<std::ptrdiff_t>(first_[static_cast<std::size_t>(site)]);
  const auto end =
      sides_.begin() + static_cast<std::ptrdiff_t>(first_[static_cast<std::size_t>(site) + 1]);
  std::sort(begin, end, [](const Side& a, const Side& b) {
    return std::tie(a.to, a.image) < std::tie(b.to, b.image);
  });
  double surface = 0;
  double volume = 0;
  for (auto side = begin; side != end; ++side) {
    if (side->area <= smallest_face) continue;
    diagram.faces.push_back(face_to(site, {side->to, side->image}, side->area));
    surface += side->area;
    volume += side->area * diagram.faces.back().to_neighbour.norm() / 6;
  }
  diagram.volume.push_back(volume);
  diagram.surface.push_back(surface);
}

std::array<HalfSpace, 6> Dual::box_around(const Eigen::Vector3d& point) const {
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
double Dual::clip(std::int32_t site) {
  delaunay_.neighbours(site, neighbours_);
  // Near ones first, so that few cuts are made in vain; and an order that leaves no choice.
  std::vector<std::tuple<double, std::int32_t, std::int32_t>> ranks;
  for (const SiteImage& other : neighbours_) {
    ranks.emplace_back(delaunay_.offset(site, other).squaredNorm(), other.site, other.image);
  }
  std::sort(ranks.begin(), ranks.end());

  polyhedron_.reset(box_around(sites_.col(site)));
  plane_site_.clear();
  for (const auto& [distance2, other, image] : ranks) {
    if (distance2 < same_place * same_place) throw_same_place(site, other, grains_);
    if (other == site && std::abs(image) == 1) continue;  // a plane of the box already
    if (polyhedron_.clip(bisector_to(delaunay_.offset(site, {other, image})))) {
      plane_site_.push_back({other, image});
    }
  }
  for (std::size_t k = 0; k < polyhedron_.corners(); ++k) {
    const Eigen::Vector3d corner = polyhedron_.corner(k);
    note_reach(sites_(2, site) + corner.z(), corner.norm());
  }
  return polyhedron_.measure(areas_);
}

void Dual::measure_clipped(std::int32_t site, VoronoiDiagram& diagram) {
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
  std::sort(diagram.faces.begin() + static_cast<std::ptrdiff_t>(begin), diagram.faces.end(),
            [](const VoronoiFace& a, const VoronoiFace& b) {
              return std::tuple(a.kind, a.neighbour, a.to_neighbour.z()) <
                     std::tuple(b.kind, b.neighbour, b.to_neighbour.z());
            });
}

VoronoiDiagram Dual::measure(WallGrainCells wall_grain_cells) {
  while (true) {
    reach_ = 0;
    VoronoiDiagram diagram = measure_all(wall_grain_cells);
    if (reach_ <= delaunay_.margin()) return diagram;
    delaunay_.widen((1 + 1e-9) * reach_);
  }
}

VoronoiDiagram Dual::measure_all(WallGrainCells wall_grain_cells) {
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
