// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/analysis/oracles.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <deque>
#include <numbers>
#include <voro++/voro++.hh>

#include "analysis/voronoi.hpp"

namespace shearcell::test {
namespace {

/// voro++'s container with everything in it. Grains have ids 0 .. n-1, wall grains the next.
class VoroContainer {
 public:
  VoroContainer(const Packing& p, double sites_per_block)
      : sites_(wrapped_sites(p.cell, p.pose, p.grains)),
        blocks_per_d_(
            std::cbrt(static_cast<double>(sites_.cols()) / volume_of(p) / sites_per_block)),
        beyond_(0.5 + (p.pose.top - p.pose.bottom) * std::abs(p.pose.tan_theta)),
        container_(-beyond_, p.cell.width + beyond_, p.pose.bottom - 0.5, p.pose.top + 0.5, 0,
                   p.cell.depth, blocks(p.cell.width + 2 * beyond_),
                   blocks(p.pose.top - p.pose.bottom + 1), blocks(p.cell.depth), false, false, true,
                   8) {
    for (Eigen::Index i = 0; i < sites_.cols(); ++i) {
      container_.put(static_cast<int>(i), sites_(0, i), sites_(1, i), sites_(2, i));
    }
    for (const WallPlane& plane : wall_planes(p.cell, p.pose)) {
      const double x = -plane.normal[0], y = -plane.normal[1];
      const int id = -1 - static_cast<int>(walls_.size());
      walls_.emplace_back(x, y, 0, x * plane.point[0] + y * plane.point[1], id);
      container_.add_wall(walls_.back());
    }
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
  int blocks(double length) const { return std::max(1, static_cast<int>(length * blocks_per_d_)); }

  Eigen::Matrix3Xd sites_;
  double blocks_per_d_;
  double beyond_;  // the width of the cell: room for the tilt
  std::deque<voro::wall_plane> walls_;
  voro::container container_;
};

VoroCell described(voro::voronoicell_neighbor& cell) {
  VoroCell found{cell.volume(), cell.surface_area(), 0, {}};
  std::vector<int> neighbours;
  std::vector<double> areas;
  std::vector<double> normals;
  cell.neighbors(neighbours);
  cell.face_areas(areas);
  cell.normals(normals);
  for (std::size_t f = 0; f < areas.size(); ++f) {
    if (neighbours[f] >= 0 && areas[f] >= 1e-10) found.neighbours.insert(neighbours[f]);
  }
  double sum = 0;
  for (unsigned m = 0; m <= 6; ++m) {
    std::complex<double> moment = 0;
    for (std::size_t f = 0; f < areas.size(); ++f) {
      if (neighbours[f] < 0) continue;
      const double polar = std::acos(std::clamp(normals[3 * f + 2], -1.0, 1.0));
      const double azimuth = std::atan2(normals[3 * f + 1], normals[3 * f]);
      moment += areas[f] / found.surface * std::sph_legendre(6, m, polar) *
                std::polar(1.0, m * azimuth);  // whose first argument may not be negative
    }
    sum += (m == 0 ? 1 : 2) * std::norm(moment);
  }
  found.q6 = std::sqrt(4 * std::numbers::pi / 13 * sum);
  return found;
}

}  // namespace

std::vector<VoroCell> voro_cells(const Packing& p) {
  VoroContainer container(p, 6);
  const auto grains = static_cast<int>(p.grains.cols());
  std::vector<VoroCell> cells(static_cast<std::size_t>(grains), VoroCell{-1, -1, -1, {}});
  container.for_each_grain(grains, [&](int id, voro::voronoicell_neighbor& cell) {
    cells[static_cast<std::size_t>(id)] = described(cell);
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

}  // namespace shearcell::test
