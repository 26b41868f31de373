// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/diagnostics.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact.hpp"
#include "core/linked_cells.hpp"

namespace shearcell {
namespace {

using Visit = std::function<void(const Contact&)>;

void visit_planes(const Cell& cell, const WallPose& pose, std::int32_t i, const Eigen::Vector3d& p,
                  const Visit& visit) {
  using V = Eigen::Vector3d;
  const V left(pose.cos_theta, -pose.sin_theta, 0);
  const V ends[2] = {V(0, pose.top, 0), V(cell.width, pose.top, 0)};
  const V normals[4] = {left, -left, V(0, 1, 0), V(0, -1, 0)};
  const V points[4] = {ends[0], ends[1], V(0, pose.bottom, 0), ends[0]};
  for (std::size_t w = 0; w < 4; ++w) {
    const V r = p - points[w];
    const double distance = r.x() * normals[w].x() + r.y() * normals[w].y();
    if (distance < 0.5) {
      visit({Contact::Kind::wall_plane, i, static_cast<std::int32_t>(w), static_cast<WallSide>(w),
             0.5 - distance, normals[w]});
    }
  }
}

}  // namespace

void for_each_contact(const Cell& cell, const Eigen::Matrix3Xd& positions, const WallPose& pose,
                      const Visit& visit) {
  const Eigen::Matrix3Xd walls = wall_grain_positions(cell, pose);
  const Eigen::Index grains = positions.cols();
  const auto site = [&](std::int32_t s) -> Eigen::Vector3d {
    return s < grains ? positions.col(s) : walls.col(s - grains);
  };
  const auto untilted = [&pose](const Eigen::Vector3d& p) {
    return p.x() - pose.tan_theta * (p.y() - pose.top);
  };
  LinkedCells near(cell.width, pose.bottom, pose.top, cell.depth,
                   std::sqrt(1 + pose.tan_theta * pose.tan_theta),
                   static_cast<std::size_t>(grains + walls.cols()));
  for (auto s = static_cast<std::int32_t>(grains + walls.cols()); s-- > 0;) {
    const Eigen::Vector3d p = site(s);
    near.insert(s, untilted(p), p.y(), p.z());
  }
  for (std::int32_t i = 0; i < grains; ++i) {
    const Eigen::Vector3d p = site(i);
    near.for_each_near(untilted(p), p.y(), p.z(), [&](std::int32_t j) {
      if (j <= i) return;
      Eigen::Vector3d r = p - site(j);
      r.z() = nearest_image(r.z(), cell.depth, 1 / cell.depth);
      const double square = r.squaredNorm();
      if (!(square < 1)) return;
      const double distance = std::sqrt(square);
      Contact contact{Contact::Kind::grain, i, j, WallSide::left, 1 - distance, r / distance};
      if (j >= grains) {
        contact.kind = Contact::Kind::wall_grain;
        contact.other = j - static_cast<std::int32_t>(grains);
        contact.side = cell.wall_grains[static_cast<std::size_t>(contact.other)].side;
      }
      visit(contact);
    });
    visit_planes(cell, pose, i, p, visit);
  }
}

Diagnostics diagnose(const Cell& cell, const Scene& scene, const State& state,
                     const WallPose& pose) {
  Diagnostics d;
  const WallSide moving = cell.moving == MovingWall::bottom ? WallSide::bottom : WallSide::top;
  std::size_t touches = 0, pairs = 0;
  double push = 0;
  for_each_contact(cell, state.position, pose, [&](const Contact& c) {
    if (c.kind == Contact::Kind::grain) {
      ++pairs;
      d.mean_overlap += c.overlap;
    }
    if (c.kind != Contact::Kind::wall_plane) {
      touches += c.kind == Contact::Kind::grain ? 2 : 1;
      d.largest_overlap = std::max(d.largest_overlap, c.overlap);
    }
    if (c.kind != Contact::Kind::grain && c.side == moving) push += c.overlap * c.normal.y();
  });
  if (pairs > 0) d.mean_overlap /= static_cast<double>(pairs);
  const auto grains = static_cast<double>(state.position.cols());
  d.contacts_per_grain = static_cast<double>(touches) / grains;
  d.kinetic_energy = 0.5 * state.velocity.squaredNorm() / grains;
  const double inwards = cell.moving == MovingWall::bottom ? 1 : -1;
  const double pressure = scene.pressure * cell.width * cell.depth;
  const double load =
      pressure + carried_weight(scene, cell, static_cast<std::size_t>(state.position.cols()));
  d.wall_imbalance =
      (load - inwards * scene.stiffness * push) / (scene.pressure > 0 ? pressure : scene.stiffness);
  return d;
}

}  // namespace shearcell
