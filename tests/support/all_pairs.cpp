// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/all_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/contact.hpp"
#include "core/drive.hpp"

namespace shearcell::test {
namespace {

struct Sum {
  double x = 0, y = 0, z = 0;
  void add(double factor, const Eigen::Vector3d& dr) {
    x = std::fma(factor, dr.x(), x);
    y = std::fma(factor, dr.y(), y);
    z = std::fma(factor, dr.z(), z);
  }
};

// One contact as the model defines it, without any list.
void add_contact(Sum& sum, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double depth) {
  const Eigen::Vector3d dr(a.x() - b.x(), a.y() - b.y(),
                           nearest_image(a.z() - b.z(), depth, 1 / depth));
  const double s = one_minus_square(dr.x(), dr.y(), dr.z());
  if (s > 0) sum.add(contact_factor(s), dr);
}

void add_plane(Sum& sum, const Cell& cell, const WallPose& pose, const Eigen::Vector3d& p,
               std::size_t side) {
  const double points[4][2] = {
      {0, pose.top}, {cell.width, pose.top}, {0, pose.bottom}, {0, pose.top}};
  const double normals[4][2] = {
      {pose.cos_theta, -pose.sin_theta}, {-pose.cos_theta, pose.sin_theta}, {0, 1}, {0, -1}};
  const double distance = std::fma(p.x() - points[side][0], normals[side][0],
                                   (p.y() - points[side][1]) * normals[side][1]);
  const double overlap = std::max(0.5 - distance, 0.0);
  sum.add(overlap, {normals[side][0], normals[side][1], 0});
}

void add_wall_grains(Sum& sum, const Cell& cell, const WallPose& pose, const Eigen::Vector3d& p,
                     std::size_t moving, bool of_moving) {
  for (const WallGrain& grain : cell.wall_grains) {
    if ((static_cast<std::size_t>(grain.side) == moving) != of_moving) continue;
    add_contact(sum, p, wall_grain_position(cell, pose, grain), cell.depth);
  }
}

// What the fluid that follows the walls adds to vx for each d below the top wall in one step.
double flow_of(const Scene& scene, const Drive& drive, const WallPose& pose, std::uint64_t step) {
  double share = 0;
  switch (scene.fluid) {
    case Fluid::still:
      return 0;
    case Fluid::cell:
      share = 1;
      break;
  }
  if (drive.amplitude == 0) return 0;
  const double omega =
      2 * std::numbers::pi / (static_cast<double>(drive.steps_per_cycle) * scene.time_step);
  const double rate = share * (tilt(drive, step).rate * omega / (pose.cos_theta * pose.cos_theta));
  return scene.time_step * scene.drag_rate * rate / (1 + 0.5 * scene.drag_rate * scene.time_step);
}

}  // namespace

Pushes pushes_over_all_pairs(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& at) {
  const std::size_t moving = cell.moving == MovingWall::bottom ? 2 : 3;
  Pushes pushes{Eigen::Matrix3Xd(3, at.cols())};
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    const Eigen::Vector3d p = at.col(i);
    Sum sum;
    add_plane(sum, cell, pose, p, moving);
    add_wall_grains(sum, cell, pose, p, moving, true);
    pushes.of_moving_wall += sum.y;
    for (std::size_t side = 0; side < 4; ++side) {
      if (side != moving) add_plane(sum, cell, pose, p, side);
    }
    add_wall_grains(sum, cell, pose, p, moving, false);
    for (Eigen::Index j = 0; j < at.cols(); ++j) {
      if (j != i) add_contact(sum, p, at.col(j), cell.depth);
    }
    pushes.on_grain.col(i) << sum.x, sum.y, sum.z;
  }
  return pushes;
}

void step_over_all_pairs(const Cell& cell, const Scene& scene, const Drive& drive, State& state) {
  const WallPose pose = wall_pose(cell, tilt(drive, state.step).theta, state.wall_height);
  const double flow = flow_of(scene, drive, pose, state.step);
  const double half = 0.5 * scene.drag_rate * scene.time_step;
  const double implicit = 1 / (1 + half);
  const double keep = (1 - half) * implicit;
  const double kick = scene.time_step * scene.stiffness * implicit;
  const Pushes pushes = pushes_over_all_pairs(cell, pose, state.position);
  for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
    const Eigen::Vector3d p = state.position.col(i), push = pushes.on_grain.col(i);
    auto v = state.velocity.col(i);
    v.x() = std::fma(kick, push.x(), keep * v.x());
    if (flow != 0) v.x() = std::fma(flow, p.y() - pose.top, v.x());
    v.y() = std::fma(kick, push.y(), keep * v.y()) - scene.time_step * scene.gravity * implicit;
    v.z() = std::fma(kick, push.z(), keep * v.z());
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      state.position(axis, i) = std::fma(scene.time_step, v(axis), p(axis));
    }
  }
  const double area = cell.width * cell.depth;
  const bool bottom_moves = cell.moving == MovingWall::bottom;
  const double inwards = bottom_moves ? 1 : -1;
  const bool lifts = scene.pressure_at == PressureAt::top && bottom_moves;
  const double weight = lifts ? scene.gravity * static_cast<double>(state.position.cols()) : 0;
  const double force =
      inwards * (scene.pressure * area + weight) - scene.stiffness * pushes.of_moving_wall;
  const double wall_half = 0.5 * scene.time_step * scene.wall_drag / scene.wall_mass;
  const bool pause = state.step % cycle_steps(drive) >= drive.steps_per_cycle;
  if (pause && drive.pause_walls == PauseWalls::held) {
    state.wall_velocity = 0;
  } else {
    state.wall_velocity = ((1 - wall_half) * state.wall_velocity +
                           scene.time_step * (force / (scene.wall_mass * area))) /
                          (1 + wall_half);
    state.wall_height += scene.time_step * state.wall_velocity;
  }
  ++state.step;
}

}  // namespace shearcell::test
