// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocols/ledger.hpp"

#include <algorithm>
#include <vector>

#include "core/diagnostics.hpp"
#include "core/drive.hpp"

namespace shearcell {
namespace {

// Distance from a wall plane [d]. A grain that is farther away does not touch the wall, because
// wall grains have diameter 1, and their centres lie behind the plane.
constexpr double kWallReach = 2;

// Positions of the grains that may touch a wall.
Eigen::Matrix3Xd near_walls(const Cell& cell, const State& state, const WallPose& pose) {
  const std::array<WallPlane, 4> planes = wall_planes(cell, pose);
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
    const double x = state.position(0, i), y = state.position(1, i);
    const bool touches = std::ranges::any_of(
        planes, [&](const WallPlane& plane) { return distance_to(plane, x, y) < kWallReach; });
    if (touches) near.push_back(i);
  }
  return state.position(Eigen::all, near);
}

// Generalized forces of the grains on the walls. A wall point at height y is displaced in x by
// (y - top) tan(theta). A horizontal wall moves as a rigid body, so y is the height of its plane.
// m is the mass of a grain.
struct WallForces {
  double on_tilt = 0;  // force conjugate to tan(theta): sum of f_x (y - top) [m d^2/s^2]
  // If the bottom wall moves: sum of f_x on the bottom wall. If the top wall moves: sum of -f_x on
  // the three other walls [m d/s^2]. The product on_height * tan(theta) is the force conjugate to
  // the height of the moving wall.
  double on_height = 0;
};

// Height y of the touched wall point, which is displaced by (y - top) tan(theta).
double height_of(const Cell& cell, const WallPose& pose, const Contact& c,
                 const Eigen::Vector3d& centre) {
  if (c.side == WallSide::bottom) return pose.bottom;
  if (c.side == WallSide::top) return pose.top;
  if (c.kind == Contact::Kind::wall_plane) return centre.y() - (0.5 - c.overlap) * c.normal.y();
  return cell.wall_grains[static_cast<std::size_t>(c.other)].position.y();
}

WallForces wall_forces(const Cell& cell, const Scene& scene, const State& state,
                       const WallPose& pose) {
  const Eigen::Matrix3Xd grains = near_walls(cell, state, pose);
  const bool bottom_moves = cell.moving == MovingWall::bottom;
  WallForces sum;
  for_each_contact(cell, grains, pose, [&](const Contact& c) {
    if (c.kind == Contact::Kind::grain) return;
    const double force = -scene.stiffness * c.overlap * c.normal.x();
    sum.on_tilt += force * (height_of(cell, pose, c, grains.col(c.grain)) - pose.top);
    if (bottom_moves && c.side == WallSide::bottom) sum.on_height += force;
    if (!bottom_moves && c.side != WallSide::top) sum.on_height -= force;
  });
  return sum;
}

// Adds `sign` times the energies at the step of `here`. The velocities at this step are the mean of
// the half-step velocities in `here` and `after`.
void add_energies(const Cell& cell, const Scene& scene, const State& here, const State& after,
                  const WallPose& pose, double sign, Ledger& sum) {
  double elastic = 0;
  for_each_contact(cell, here.position, pose, [&](const Contact& c) {
    elastic += 0.5 * scene.stiffness * c.overlap * c.overlap;
  });
  const double area = cell.width * cell.depth;
  const double wall = 0.5 * (here.wall_velocity + after.wall_velocity);
  const auto grains = static_cast<std::size_t>(here.position.cols());
  const double load = scene.pressure * area + carried_weight(scene, cell, grains);
  sum.elastic += sign * elastic;
  sum.kinetic += sign * (0.5 * (0.5 * (here.velocity + after.velocity)).squaredNorm() +
                         0.5 * scene.wall_mass * area * wall * wall);
  sum.gravitational += sign * scene.gravity * here.position.row(1).sum();
  sum.load -= sign * inwards(cell) * load * here.wall_height;
}

// Power that the grains lose by drag, half a step before `state`.
double drag_power(const Cell& cell, const Scene& scene, const Drive& drive, const State& state,
                  const WallPose& pose) {
  Eigen::Matrix3Xd relative = state.velocity;
  if (const double share = fluid_share(scene.fluid); share > 0) {
    const double h = scene.time_step;
    const double before =
        wall_pose(cell, tilt(drive, state.step - 1).theta, state.wall_height).tan_theta;
    const double rate = share * (pose.tan_theta - before) / h;
    const double rising = cell.moving == MovingWall::top ? state.wall_velocity : 0;
    relative.row(0).array() -= rate * (state.position.row(1).array() - pose.top -
                                       0.5 * h * (state.velocity.row(1).array() - rising));
  }
  return scene.drag_rate * state.velocity.cwiseProduct(relative).sum();
}

}  // namespace

Ledger ledger(const Cell& cell, const Scene& scene, const Drive& drive, const State& start,
              std::uint64_t steps, std::uint64_t stride) {
  const auto pose_of = [&](const State& state) {
    return wall_pose(cell, tilt(drive, state.step).theta, state.wall_height);
  };
  Simulation simulation(cell, scene, start);
  simulation.set_overlap_limit(kLargestOverlapLimit);
  simulation.advance(drive, 1);
  Ledger sum;
  add_energies(cell, scene, start, simulation.state(), pose_of(start), -1, sum);

  const std::uint64_t end = start.step + steps;
  const double area = cell.width * cell.depth;
  State here = start;
  WallPose pose = pose_of(here);
  WallForces forces = wall_forces(cell, scene, here, pose);
  while (here.step < end) {
    const std::uint64_t to = std::min(end, here.step + std::max<std::uint64_t>(1, stride));
    simulation.advance(drive, to - simulation.step());
    State next = simulation.state();
    const WallPose next_pose = pose_of(next);
    const WallForces next_forces = wall_forces(cell, scene, next, next_pose);
    sum.work_of_walls -=
        0.5 * (forces.on_tilt + next_forces.on_tilt) * (next_pose.tan_theta - pose.tan_theta) +
        0.5 * (forces.on_height * pose.tan_theta + next_forces.on_height * next_pose.tan_theta) *
            (next.wall_height - here.wall_height);
    const double seconds = static_cast<double>(to - here.step) * scene.time_step;
    sum.lost_by_grains += seconds * drag_power(cell, scene, drive, next, next_pose);
    sum.lost_by_wall += seconds * scene.wall_drag * area * next.wall_velocity * next.wall_velocity;
    here = std::move(next);
    pose = next_pose;
    forces = next_forces;
  }
  simulation.advance(drive, 1);
  add_energies(cell, scene, here, simulation.state(), pose, 1, sum);
  return sum;
}

}  // namespace shearcell
