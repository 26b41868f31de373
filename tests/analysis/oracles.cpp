// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/analysis/oracles.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <voro++/voro++.hh>

#include "analysis/voronoi.hpp"

namespace shearcell::testing {
namespace {

/// voro++'s container with everything in it. Grains have ids 0 .. n-1, wall grains the next.
class VoroContainer {
 public:
  VoroContainer(const Packing& p, double sites_per_block)
      : sites_(wrapped_sites(p.cell, p.pose, p.grains)),
        left_(-p.pose.cos_theta, p.pose.sin_theta, 0, p.pose.sin_theta * p.pose.top, -1),
        right_(p.pose.cos_theta, -p.pose.sin_theta, 0,
               p.cell.width * p.pose.cos_theta - p.pose.sin_theta * p.pose.top, -2),
        bottom_(0, -1, 0, -p.pose.bottom, -3),
        top_(0, 1, 0, p.pose.top, -4),
        container_(low(p), high(p), p.pose.bottom - 0.5, p.pose.top + 0.5, 0, p.cell.depth,
                   blocks(p, high(p) - low(p), sites_per_block),
                   blocks(p, p.pose.top - p.pose.bottom + 1, sites_per_block),
                   blocks(p, p.cell.depth, sites_per_block), false, false, true, 8) {
    for (Eigen::Index i = 0; i < sites_.cols(); ++i) {
      container_.put(static_cast<int>(i), sites_(0, i), sites_(1, i), sites_(2, i));
    }
    container_.add_wall(left_);
    container_.add_wall(right_);
    container_.add_wall(bottom_);
    container_.add_wall(top_);
  }

  template <typename Visit>
  void for_each_grain(int grains, Visit&& visit) {
    voro::c_loop_all loop(container_);
    voro::voronoicell_neighbor cell;
    if (!loop.start()) return;
    do {
      if (loop.pid() < grains && container_.compute_cell(cell, loop)) visit(loop.pid(), cell);
    } while (loop.inc());
  }

 private:
  static double low(const Packing& p) {
    return std::min(0.0, (p.pose.bottom - p.pose.top) * p.pose.tan_theta) - 0.5;
  }
  static double high(const Packing& p) {
    return p.cell.width + std::max(0.0, (p.pose.bottom - p.pose.top) * p.pose.tan_theta) + 0.5;
  }
  static int blocks(const Packing& p, double length, double sites_per_block) {
    const auto sites =
        static_cast<double>(p.grains.cols()) + static_cast<double>(p.cell.wall_grains.size());
    return std::max(1,
                    static_cast<int>(length * std::cbrt(sites / volume_of(p) / sites_per_block)));
  }

  Eigen::Matrix3Xd sites_;
  voro::wall_plane left_, right_, bottom_, top_;
  voro::container container_;
};

double q6_by_definition(voro::voronoicell_neighbor& cell) {
  std::vector<int> neighbours;
  std::vector<double> areas;
  std::vector<double> normals;
  cell.neighbors(neighbours);
  cell.face_areas(areas);
  cell.normals(normals);
  double surface = 0;
  for (const double area : areas) surface += area;
  double sum = 0;
  for (unsigned m = 0; m <= 6; ++m) {
    std::complex<double> moment = 0;
    for (std::size_t f = 0; f < areas.size(); ++f) {
      if (neighbours[f] < 0) continue;
      const double polar = std::acos(std::clamp(normals[3 * f + 2], -1.0, 1.0));
      const double azimuth = std::atan2(normals[3 * f + 1], normals[3 * f]);
      moment += areas[f] / surface * std::sph_legendre(6, m, polar) *
                std::polar(1.0, m * azimuth);  // whose first argument may not be negative
    }
    sum += (m == 0 ? 1 : 2) * std::norm(moment);
  }
  return std::sqrt(4 * std::numbers::pi / 13 * sum);
}

}  // namespace

std::vector<VoroCell> voro_cells(const Packing& p) {
  VoroContainer container(p, 6);
  const auto grains = static_cast<int>(p.grains.cols());
  std::vector<VoroCell> cells(static_cast<std::size_t>(grains), VoroCell{-1, -1, -1});
  container.for_each_grain(grains, [&](int id, voro::voronoicell_neighbor& cell) {
    cells[static_cast<std::size_t>(id)] = {cell.volume(), cell.surface_area(),
                                           q6_by_definition(cell)};
  });
  return cells;
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double time_voro(const Packing& p, double sites_per_block) {
  const double start = thread_seconds();
  VoroContainer container(p, sites_per_block);
  double total = 0;
  std::vector<int> neighbours;
  std::vector<double> areas;
  container.for_each_grain(static_cast<int>(p.grains.cols()),
                           [&](int, voro::voronoicell_neighbor& cell) {
                             total += cell.volume();
                             cell.neighbors(neighbours);
                             cell.face_areas(areas);
                           });
  return total > 0 ? thread_seconds() - start : -1;
}

std::vector<std::set<int>> delaunay_neighbours(const Packing& p) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Vertex = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel>;
  using Triangulation =
      CGAL::Delaunay_triangulation_3<Kernel,
                                     CGAL::Triangulation_data_structure_3<
                                         Vertex, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>>;
  const Eigen::Matrix3Xd sites = wrapped_sites(p.cell, p.pose, p.grains);
  const auto count = static_cast<int>(sites.cols());
  std::vector<std::pair<Kernel::Point_3, int>> points;
  // Images are told apart from the sites themselves by ids from `count` on.
  for (int image = -1; image <= 1; ++image) {
    for (int i = 0; i < count; ++i) {
      const int id = image == 0 ? i : count + i;
      points.emplace_back(
          Kernel::Point_3(sites(0, i), sites(1, i), sites(2, i) + image * p.cell.depth), id);
    }
  }
  const Triangulation triangulation(points.begin(), points.end());
  std::vector<std::set<int>> neighbours(static_cast<std::size_t>(p.grains.cols()));
  for (auto edge = triangulation.finite_edges_begin(); edge != triangulation.finite_edges_end();
       ++edge) {
    const int a = edge->first->vertex(edge->second)->info();
    const int b = edge->first->vertex(edge->third)->info();
    const auto note = [&](int from, int to) {
      if (from < p.grains.cols()) neighbours[static_cast<std::size_t>(from)].insert(to % count);
    };
    note(a, b);
    note(b, a);
  }
  return neighbours;
}

}  // namespace shearcell::testing
