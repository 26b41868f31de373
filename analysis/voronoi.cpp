// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/voronoi.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "analysis/clip.hpp"
#include "analysis/error.hpp"
#include "analysis/site_grid.hpp"

namespace shearcell {
namespace {

constexpr double smallest_face = 1e-13;        // [d^2]
constexpr double same_place = 1e-10;           // [d]
constexpr double first_reach_spacings = 1.75;  // holds all neighbours of most cells in a packing
constexpr double reach_growth = 1.2;

constexpr std::array<const char*, 4> side_names = {"left", "right", "bottom", "top"};

struct Candidate {
  Eigen::Vector3d offset;
  std::int32_t site;
};

/// What candidates are sorted by: small, and a total order, so that the result has no choice.
struct Rank {
  double distance2;
  std::int32_t site;
  std::uint32_t candidate;
};

/// Everything that does not change from cell to cell, and the work space.
class CellBuilder {
 public:
  CellBuilder(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains)
      : cell_(cell),
        pose_(pose),
        grain_count_(static_cast<std::int32_t>(grains.cols())),
        spacing_(site_spacing(cell, pose, grains)),
        grid_(wrapped_sites(cell, pose, grains), cell.depth, spacing_) {}

  /// Cuts the cell of one site and leaves it in polyhedron(); returns its volume.
  double build(std::int32_t site);

  /// Adds the faces of the cell that was built last; returns their whole area.
  double append_faces(std::vector<VoronoiFace>& faces) const;

  Eigen::Vector3d position(std::int32_t site) const { return grid_.sites().col(site); }
  std::string name(std::int32_t site) const {
    return site < grain_count_ ? "grain " + std::to_string(site)
                               : "wall grain " + std::to_string(site - grain_count_);
  }

 private:
  static double site_spacing(const Cell& cell, const WallPose& pose,
                             const Eigen::Matrix3Xd& grains) {
    const double volume = cell.width * cell.depth * (pose.top - pose.bottom);
    const auto sites =
        static_cast<double>(grains.cols()) + static_cast<double>(cell.wall_grains.size());
    return std::cbrt(volume / std::max(sites, 1.0));
  }

  std::array<HalfSpace, 6> box_around(const Eigen::Vector3d& point) const;
  void gather(std::int32_t site, double inner, double outer);

  const Cell& cell_;
  const WallPose& pose_;
  std::int32_t grain_count_;
  double spacing_;
  SiteGrid grid_;
  ConvexCell polyhedron_;
  std::int32_t built_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<Rank> ranks_;
  std::vector<std::int32_t> plane_site_;  // by plane index - 6
  std::vector<double> areas_;
};

std::array<HalfSpace, 6> CellBuilder::box_around(const Eigen::Vector3d& point) const {
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

void CellBuilder::gather(std::int32_t site, double inner, double outer) {
  candidates_.clear();
  ranks_.clear();
  const auto keep = [&](std::int32_t other, const Eigen::Vector3d& offset, double distance2,
                        std::int64_t image) {
    // The cell itself, and its nearest images, which are walls of the box that it starts from.
    if (other == site && std::abs(image) <= 1) return;
    ranks_.push_back({distance2, other, static_cast<std::uint32_t>(candidates_.size())});
    candidates_.push_back({offset, other});
  };
  grid_.visit_within(position(site), inner, outer, keep);
  std::sort(ranks_.begin(), ranks_.end(), [](const Rank& a, const Rank& b) {
    return std::tie(a.distance2, a.site, a.candidate) < std::tie(b.distance2, b.site, b.candidate);
  });
}

double CellBuilder::build(std::int32_t site) {
  built_ = site;
  plane_site_.clear();
  polyhedron_.reset(box_around(position(site)));
  double inner = 0;
  double outer = first_reach_spacings * spacing_;
  while (true) {
    gather(site, inner, outer);
    for (const Rank& rank : ranks_) {
      const Candidate& other = candidates_[rank.candidate];
      if (rank.distance2 < same_place * same_place) {
        throw AnalysisError(name(std::min(site, other.site)) + " and " +
                            name(std::max(site, other.site)) + " lie at the same place");
      }
      if (rank.distance2 > 4 * polyhedron_.radius_squared()) return polyhedron_.measure(areas_);
      if (polyhedron_.clip(bisector_to(other.offset))) plane_site_.push_back(other.site);
    }
    if (outer * outer > 4 * polyhedron_.radius_squared()) return polyhedron_.measure(areas_);
    inner = outer;
    outer *= reach_growth;
  }
}

double CellBuilder::append_faces(std::vector<VoronoiFace>& faces) const {
  const std::size_t begin = faces.size();
  double surface = 0;
  for (std::size_t plane = 0; plane < areas_.size(); ++plane) {
    if (areas_[plane] <= smallest_face) continue;
    VoronoiFace face;
    face.area = areas_[plane];
    const HalfSpace& half = polyhedron_.plane(plane);
    if (plane < 4) {
      face.kind = NeighbourKind::wall_plane;
      face.neighbour = static_cast<std::int32_t>(plane);
      face.to_neighbour = 2 * half.offset * half.normal;
    } else {
      const std::int32_t site = plane < 6 ? built_ : plane_site_[plane - 6];
      const bool grain = site < grain_count_;
      face.kind = grain ? NeighbourKind::grain : NeighbourKind::wall_grain;
      face.neighbour = grain ? site : site - grain_count_;
      face.to_neighbour = half.normal;
    }
    surface += face.area;
    faces.push_back(face);
  }
  std::sort(faces.begin() + static_cast<std::ptrdiff_t>(begin), faces.end(),
            [](const VoronoiFace& a, const VoronoiFace& b) {
              if (a.kind != b.kind) return a.kind < b.kind;
              if (a.neighbour != b.neighbour) return a.neighbour < b.neighbour;
              return a.to_neighbour.z() < b.to_neighbour.z();
            });
  return surface;
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
  CellBuilder builder(cell, pose, grains);
  const auto count = static_cast<std::int32_t>(grains.cols());
  VoronoiDiagram diagram;
  const auto reserve = static_cast<std::size_t>(count);
  diagram.volume.reserve(reserve);
  diagram.surface.reserve(reserve);
  diagram.first.reserve(reserve + 1);
  diagram.faces.reserve(15 * reserve);  // a little more than a dense packing has
  diagram.first.push_back(0);
  for (std::int32_t i = 0; i < count; ++i) {
    diagram.volume.push_back(builder.build(i));
    diagram.surface.push_back(builder.append_faces(diagram.faces));
    diagram.first.push_back(diagram.faces.size());
  }
  if (wall_grain_cells == WallGrainCells::measure) {
    const auto wall_grains = static_cast<std::int32_t>(cell.wall_grains.size());
    for (std::int32_t w = 0; w < wall_grains; ++w) {
      diagram.wall_grain_volume.push_back(builder.build(count + w));
    }
  }
  return diagram;
}

}  // namespace shearcell
