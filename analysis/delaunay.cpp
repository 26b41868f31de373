// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/delaunay.hpp"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <type_traits>

#include "analysis/error.hpp"

namespace shearcell {
namespace {

constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;
// A circumcentre that may be farther from the true one than this [d] is computed exactly.
constexpr double worst_error = 1e-12;

/// The edges of a tetrahedron by the numbers of its vertices.
constexpr std::array<std::array<int, 2>, 6> edges = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
/// Bit of the edge between two vertices of a tetrahedron, by their numbers.
constexpr std::array<std::array<std::uint8_t, 4>, 4> edge_bit = {
    {{0, 1, 2, 4}, {1, 0, 8, 16}, {2, 8, 0, 32}, {4, 16, 32, 0}}};

}  // namespace

void throw_same_place(std::int32_t a, std::int32_t b, std::int32_t grains) {
  const auto name = [&](std::int32_t site) {
    return site < grains ? "grain " + std::to_string(site)
                         : "wall grain " + std::to_string(site - grains);
  };
  throw AnalysisError(name(std::min(a, b)) + " and " + name(std::max(a, b)) +
                      " lie at the same place");
}

Delaunay::Delaunay(const Eigen::Matrix3Xd& sites, std::int32_t grains, double depth, double margin)
    : sites_(sites), grains_(grains), depth_(depth), margin_(margin) {
  const auto count = static_cast<std::int32_t>(sites.cols());
  vertex_.resize(static_cast<std::size_t>(count));
  std::vector<SiteImage> images;
  for (std::int32_t i = 0; i < count; ++i) images.push_back({i, 0});
  collect_images(0, margin, images);
  insert(images);
}

void Delaunay::widen(double margin) {
  std::vector<SiteImage> images;
  collect_images(margin_, margin, images);
  margin_ = margin;
  insert(images);
}

void Delaunay::collect_images(double inner, double outer, std::vector<SiteImage>& images) const {
  const auto beyond = [&](double distance) { return distance >= inner && distance < outer; };
  for (std::int32_t k = 1; (k - 1) * depth_ < outer; ++k) {
    for (std::int32_t i = 0; i < sites_.cols(); ++i) {
      if (beyond(sites_(2, i) + (k - 1) * depth_)) images.push_back({i, k});
      if (beyond(k * depth_ - sites_(2, i))) images.push_back({i, -k});
    }
  }
}

void Delaunay::insert(const std::vector<SiteImage>& images) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::size_t> order;
  points.reserve(images.size());
  order.reserve(images.size());
  for (const SiteImage& image : images) {
    const Eigen::Vector3d p = sites_.col(image.site);
    order.push_back(points.size());
    points.emplace_back(p.x(), p.y(), p.z() + image.image * depth_);
  }
  const auto position = CGAL::make_property_map(points);
  CGAL::spatial_sort(
      order.begin(), order.end(),
      CGAL::Spatial_sort_traits_adapter_3<Kernel, std::decay_t<decltype(position)>>(position));

  CellHandle hint;
  for (const std::size_t k : order) {
    const VertexHandle vertex = triangulation_.insert(points[k], hint);
    hint = vertex->cell();
    SiteImage& present = vertex->info();
    if (present.site >= 0) throw_same_place(present.site, images[k].site, grains_);
    present = images[k];
    if (present.image == 0) vertex_[static_cast<std::size_t>(present.site)] = vertex;
  }
}

Sphere Delaunay::circumsphere(CellHandle tetrahedron) const {
  const Eigen::Vector3d origin = vector(tetrahedron->vertex(0)->point());
  const Eigen::Vector3d a = vector(tetrahedron->vertex(1)->point()) - origin;
  const Eigen::Vector3d b = vector(tetrahedron->vertex(2)->point()) - origin;
  const Eigen::Vector3d c = vector(tetrahedron->vertex(3)->point()) - origin;
  const Eigen::Vector3d bc = b.cross(c);
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double cc = c.squaredNorm();
  const double determinant = a.dot(bc);
  const Eigen::Vector3d v = (aa * bc + bb * c.cross(a) + cc * a.cross(b)) / (2 * determinant);
  const double radius2 = v.squaredNorm();

  // Forward error of Cramer's rule: numerator and determinant each lose a few roundoffs of the
  // products of their edges' lengths, which are at most `longest`. 32 covers the operations counted
  // one by one.
  const double longest2 = std::max({aa, bb, cc});
  const double terms = longest2 * (longest2 + std::sqrt(longest2 * radius2));
  if (32 * unit_roundoff * terms < worst_error * determinant) return {origin + v, radius2};

  using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
  std::array<Exact::Point_3, 4> p;
  for (int k = 0; k < 4; ++k) {
    const Kernel::Point_3& q = tetrahedron->vertex(k)->point();
    p[static_cast<std::size_t>(k)] = Exact::Point_3(q.x(), q.y(), q.z());
  }
  const Exact::Point_3 centre = CGAL::circumcenter(p[0], p[1], p[2], p[3]);
  return {{CGAL::to_double(centre.x()), CGAL::to_double(centre.y()), CGAL::to_double(centre.z())},
          CGAL::to_double(CGAL::squared_distance(centre, p[0]))};
}

std::vector<DualFace> Delaunay::faces(const std::vector<std::uint8_t>& wanted) {
  const auto is_wanted = [&](const SiteImage& v) {
    return v.image == 0 && v.site >= 0 && wanted[static_cast<std::size_t>(v.site)] != 0;
  };
  std::vector<DualFace> found;
  found.reserve(8 * vertex_.size());  // 15.5 edges meet at a site, and each is shared by two
  edges_done_.assign(centre_.size(), 0);
  for (CellHandle cell : triangulation_.all_cell_handles()) {
    std::array<bool, 4> corner;
    for (std::size_t k = 0; k < 4; ++k) {
      corner[k] = is_wanted(cell->vertex(static_cast<int>(k))->info());
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto [i, j] = edges[e];
      if (!corner[static_cast<std::size_t>(i)] && !corner[static_cast<std::size_t>(j)]) continue;
      if ((edges_done_[cell->info()] >> e & 1U) != 0) continue;
      const VertexHandle a = cell->vertex(i);
      const VertexHandle b = cell->vertex(j);
      found.push_back({a->info(), b->info(), face_area(cell, a, b)});
    }
  }
  return found;
}

double Delaunay::face_area(CellHandle start, VertexHandle a, VertexHandle b) {
  // The face is the polygon of the circumcentres around the edge, which turn one way.
  const Eigen::Vector3d first = centre_[start->info()];
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  CellHandle cell = start;
  do {
    const int i = cell->index(a);
    const int j = cell->index(b);
    edges_done_[cell->info()] |= edge_bit[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    const Eigen::Vector3d next = centre_[cell->info()] - first;
    twice += arm.cross(next);
    arm = next;
    cell = cell->neighbor(Triangulation::next_around_edge(i, j));
  } while (cell != start);
  const Eigen::Vector3d edge = vector(b->point()) - vector(a->point());
  const double length2 = edge.squaredNorm();
  if (length2 < same_place * same_place) {
    throw_same_place(a->info().site, b->info().site, grains_);
  }
  return edge.dot(twice) / (2 * std::sqrt(length2));
}

void Delaunay::neighbours(std::int32_t site, std::vector<SiteImage>& found) const {
  found.clear();
  if (triangulation_.dimension() < 1) return;
  std::vector<VertexHandle> adjacent;
  triangulation_.finite_adjacent_vertices(vertex_[static_cast<std::size_t>(site)],
                                          std::back_inserter(adjacent));
  for (const VertexHandle& vertex : adjacent) found.push_back(vertex->info());
}

}  // namespace shearcell
