// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/delaunay.hpp"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <type_traits>

#include "analysis/error.hpp"

namespace shearcell {
namespace {

// A circumcentre that may be farther from the true one than this [d] is computed exactly.
constexpr double worst_centre_error = 1e-12;

/// The edges of a tetrahedron by the numbers of its corners.
constexpr std::array<std::array<std::uint8_t, 2>, 6> edges = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
/// The bit of the edge between two corners.
constexpr std::array<std::array<std::uint8_t, 4>, 4> edge_bit = {
    {{0, 1, 2, 4}, {1, 0, 8, 16}, {2, 8, 0, 32}, {4, 16, 32, 0}}};

/// Number of the corner that is `vertex`, which must be one of the four.
std::size_t corner_of(const Tetrahedron& t, std::int32_t vertex) {
  return (t.vertex[1] == vertex ? 1U : 0U) + (t.vertex[2] == vertex ? 2U : 0U) +
         (t.vertex[3] == vertex ? 3U : 0U);
}

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
    : sites_(sites), grains_(grains), depth_(depth) {
  for (std::int32_t i = 0; i < sites.cols(); ++i) add_point({i, 0});
  widen(margin);
}

void Delaunay::widen(double margin) {
  const auto is_new = [&](double distance) { return distance >= margin_ && distance < margin; };
  for (std::int32_t k = 1; (k - 1) * depth_ < margin; ++k) {
    for (std::int32_t i = 0; i < sites_.cols(); ++i) {
      if (is_new(sites_(2, i) + (k - 1) * depth_)) add_point({i, k});
      if (is_new(k * depth_ - sites_(2, i))) add_point({i, -k});
    }
  }
  margin_ = margin;
  insert_points();
  copy_tetrahedra();
}

void Delaunay::add_point(SiteImage image) {
  image_.push_back(image);
  point_.push_back(sites_.col(image.site));
  point_.back().z() += image.image * depth_;
}

void Delaunay::insert_points() {
  const std::size_t first = handle_.size();
  std::vector<Kernel::Point_3> points;
  points.reserve(point_.size());
  for (const Eigen::Vector3d& p : point_) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::size_t> order(point_.size() - first);
  std::iota(order.begin(), order.end(), first);
  const auto position = CGAL::make_property_map(points);
  CGAL::spatial_sort(
      order.begin(), order.end(),
      CGAL::Spatial_sort_traits_adapter_3<Kernel, std::decay_t<decltype(position)>>(position));

  handle_.resize(point_.size());
  Triangulation::Cell_handle hint;
  for (const std::size_t k : order) {
    const Triangulation::Vertex_handle vertex = triangulation_.insert(points[k], hint);
    std::int32_t& number = vertex->info().value;
    if (number >= 0) {
      throw_same_place(image_[static_cast<std::size_t>(number)].site, image_[k].site, grains_);
    }
    number = static_cast<std::int32_t>(k);
    handle_[k] = vertex;
    hint = vertex->cell();
  }
}

void Delaunay::copy_tetrahedra() {
  if (triangulation_.dimension() < 3) return;
  std::int32_t count = 0;
  for (const auto cell : triangulation_.all_cell_handles()) cell->info().value = count++;
  tetrahedra_.resize(static_cast<std::size_t>(count));
  auto copy = tetrahedra_.begin();
  for (const auto cell : triangulation_.all_cell_handles()) {
    bool any_grain = false;
    for (int k = 0; k < 4; ++k) {
      const std::int32_t vertex = cell->vertex(k)->info().value;
      any_grain = any_grain || (vertex >= 0 && vertex < grains_);
      copy->vertex[static_cast<std::size_t>(k)] = vertex;
      copy->neighbour[static_cast<std::size_t>(k)] = cell->neighbor(k)->info().value;
    }
    if (any_grain && copy->bounded()) copy->centre = circumcentre(copy->vertex);
    ++copy;
  }
}

Eigen::Vector3d Delaunay::circumcentre(const std::array<std::int32_t, 4>& vertices) const {
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

  // Forward error of Cramer's rule: numerator and determinant each lose a few roundoffs of the
  // products of the edges' lengths, none above the longest. 32 covers the operations counted one
  // by one.
  constexpr double roundoff = std::numeric_limits<double>::epsilon() / 2;
  const double longest2 = std::max({aa, bb, cc});
  const double terms = longest2 * (longest2 + std::sqrt(longest2 * v.squaredNorm()));
  if (32 * roundoff * terms < worst_centre_error * determinant) return origin + v;

  using Rational = CGAL::Simple_cartesian<CGAL::Exact_rational>;
  const auto exact = [&](std::size_t k) {
    const Eigen::Vector3d& p = point(vertices[k]);
    return Rational::Point_3(p.x(), p.y(), p.z());
  };
  const Rational::Point_3 centre = CGAL::circumcenter(exact(0), exact(1), exact(2), exact(3));
  return {CGAL::to_double(centre.x()), CGAL::to_double(centre.y()), CGAL::to_double(centre.z())};
}

std::vector<DualFace> Delaunay::faces(const std::vector<std::uint8_t>& wanted) {
  const auto is_wanted = [&](std::int32_t vertex) {
    const auto v = static_cast<std::size_t>(vertex);
    return v < wanted.size() && wanted[v] != 0;  // false for -1, which is large as unsigned
  };
  std::vector<DualFace> found;
  found.reserve(8 * wanted.size());  // 15.5 edges meet at a site, and each has two ends
  for (Tetrahedron& t : tetrahedra_) t.edges_done = 0;
  for (std::size_t k = 0; k < tetrahedra_.size(); ++k) {
    const Tetrahedron& t = tetrahedra_[k];
    std::array<bool, 4> end;
    for (std::size_t i = 0; i < 4; ++i) end[i] = is_wanted(t.vertex[i]);
    for (const auto [i, j] : edges) {
      if ((!end[i] && !end[j]) || (t.edges_done & edge_bit[i][j]) != 0) continue;
      const double area = face_area(static_cast<std::int32_t>(k), i, j);
      found.push_back({image_[static_cast<std::size_t>(t.vertex[i])],
                       image_[static_cast<std::size_t>(t.vertex[j])], area});
    }
  }
  return found;
}

double Delaunay::face_area(std::int32_t start, std::size_t i, std::size_t j) {
  // The face is the polygon of the circumcentres of the tetrahedra around the edge from i to j.
  const Tetrahedron& first = tetrahedra_[static_cast<std::size_t>(start)];
  const std::int32_t a = first.vertex[i];
  const std::int32_t b = first.vertex[j];
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  std::int32_t k = start;
  do {
    Tetrahedron& t = tetrahedra_[static_cast<std::size_t>(k)];
    i = corner_of(t, a);
    j = corner_of(t, b);
    t.edges_done = static_cast<std::uint8_t>(t.edges_done | edge_bit[i][j]);
    const Eigen::Vector3d next = t.centre - first.centre;
    twice += arm.cross(next);
    arm = next;
    const int across = Triangulation::next_around_edge(static_cast<int>(i), static_cast<int>(j));
    k = t.neighbour[static_cast<std::size_t>(across)];
  } while (k != start);
  const Eigen::Vector3d edge = point(b) - point(a);
  const double length = edge.norm();
  if (length < coincidence_distance) {
    throw_same_place(image_[static_cast<std::size_t>(a)].site,
                     image_[static_cast<std::size_t>(b)].site, grains_);
  }
  return edge.dot(twice) / (2 * length);
}

std::vector<SiteImage> Delaunay::neighbours(std::int32_t site) const {
  std::vector<SiteImage> found;
  if (triangulation_.dimension() < 1) return found;
  std::vector<Triangulation::Vertex_handle> adjacent;
  triangulation_.finite_adjacent_vertices(handle_[static_cast<std::size_t>(site)],
                                          std::back_inserter(adjacent));
  for (const auto& vertex : adjacent) {
    found.push_back(image_[static_cast<std::size_t>(vertex->info().value)]);
  }
  return found;
}

}  // namespace shearcell
