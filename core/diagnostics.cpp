// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/diagnostics.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact.hpp"
#include "core/linked_cells.hpp"

namespace shearcell {
namespace {

using Visit = std::function<void(const Contact&)>;

void visit_planes(const std::array<WallPlane, 4>& planes, std::int32_t i, const Eigen::Vector3d& p,
                  const Visit& visit) {
  for (std::size_t w = 0; w < 4; ++w) {
    const double distance = distance_to(planes[w], p.x(), p.y());
    if (!(distance < 0.5)) continue;
    const auto& normal = planes[w].normal;
    visit({Contact::Kind::wall_plane, i, static_cast<std::int32_t>(w), static_cast<WallSide>(w),
           0.5 - distance, Eigen::Vector3d(normal[0], normal[1], 0)});
  }
}

}  // namespace

void for_each_contact(const Cell& cell, const Eigen::Matrix3Xd& positions, const WallPose& pose,
                      const Visit& visit) {
  const Eigen::Matrix3Xd walls = wall_grain_positions(cell, pose);
  const auto planes = wall_planes(cell, pose);
  const Eigen::Index grains = positions.cols();
  const auto site = [&](std::int32_t s) -> Eigen::Vector3d {
    return s < grains ? positions.col(s) : walls.col(s - grains);
  };
  const auto sites = static_cast<std::int32_t>(grains + walls.cols());
  LinkedCells near(cell, pose, 1.0, static_cast<std::size_t>(sites));
  for (std::int32_t s = sites; s-- > 0;) near.insert(s, site(s));
  for (std::int32_t i = 0; i < grains; ++i) {
    const Eigen::Vector3d p = site(i);
    near.for_each_near(p, [&](std::int32_t j) {
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
    visit_planes(planes, i, p, visit);
  }
}

double force_unit(const Scene& scene) {
  return scene.pressure > 0 ? scene.pressure : std::max(scene.gravity, 1.0);
}

Diagnostics diagnose(const Cell& cell, const Scene& scene, const State& state,
                     const WallPose& pose) {
  Diagnostics d;
  const WallSide moving = moving_side(cell);
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
  const double pressure = scene.pressure * cell.width * cell.depth;
  const double load =
      pressure + carried_weight(scene, cell, static_cast<std::size_t>(state.position.cols()));
  d.wall_imbalance = (load - inwards(cell) * scene.stiffness * push) /
                     (scene.pressure > 0 ? pressure : scene.stiffness);
  return d;
}

}  // namespace shearcell
