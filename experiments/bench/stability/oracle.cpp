// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/stability/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/diagnostics.hpp"

namespace shearcell::stability {
namespace {

using V = Eigen::Vector3d;

struct Walls {
  double tangent, bottom, top;
};

struct Angle {
  double value = 0, rate = 0;  // [rad], [rad/s]
};

Angle angle(const Drive& drive, double time_step, std::uint64_t step) {
  const std::uint64_t phase = step % (drive.steps_per_cycle + drive.pause_steps);
  if (phase >= drive.steps_per_cycle) return {};
  const double turn = 2 * std::numbers::pi / static_cast<double>(drive.steps_per_cycle);
  const double at = turn * static_cast<double>(phase);
  return {drive.amplitude * std::sin(at), drive.amplitude * turn / time_step * std::cos(at)};
}

Walls walls_at(const Cell& cell, double angle, const State& state) {
  const bool bottom_moves = cell.moving == MovingWall::bottom;
  return {std::tan(angle), bottom_moves ? state.wall_height : cell.bottom,
          bottom_moves ? cell.top : state.wall_height};
}

// Position of a wall grain: side walls tilt about the top wall, the others keep their shape.
V wall_grain_at(const Cell& cell, const Walls& walls, const WallGrain& grain) {
  V p = grain.position;
  if (grain.side == WallSide::left || grain.side == WallSide::right) {
    p.x() += (p.y() - walls.top) * walls.tangent;
  } else if (grain.side == WallSide::bottom) {
    p += V((walls.bottom - walls.top) * walls.tangent, walls.bottom - cell.bottom, 0);
  } else {
    p.y() += walls.top - cell.top;
  }
  return p;
}

// Overlap times normal of a grain at p with every image of a sphere at q.
V push_of_images(const V& p, const V& q, double depth, bool itself) {
  V sum = V::Zero();
  const double nearest = std::floor((p.z() - q.z()) / depth);
  for (const double image : {nearest - 1, nearest, nearest + 1, nearest + 2}) {
    if (itself && image == 0) continue;
    const V dr = p - q - V(0, 0, image * depth);
    const double r = dr.norm();
    if (r < 1 && r > 0) sum += (1 - r) / r * dr;
  }
  return sum;
}

V push_of_plane(const V& p, const V& point, const V& normal) {
  return std::max(0.0, 0.5 - (p - point).dot(normal)) * normal;
}

struct Pushes {
  Eigen::Matrix3Xd on_grain;
  double of_moving_wall = 0;  // upwards, on all grains
};

Pushes pushes(const Cell& cell, const Walls& walls, const Eigen::Matrix3Xd& at) {
  const V across = V(1, -walls.tangent, 0).normalized();
  const V points[4] = {
      {0, walls.top, 0}, {cell.width, walls.top, 0}, {0, walls.bottom, 0}, {0, walls.top, 0}};
  const V normals[4] = {across, -across, {0, 1, 0}, {0, -1, 0}};
  const WallSide moving = cell.moving == MovingWall::bottom ? WallSide::bottom : WallSide::top;
  Pushes sum{Eigen::Matrix3Xd::Zero(3, at.cols())};
  const auto of_wall = [&](Eigen::Index i, WallSide side, const V& push) {
    sum.on_grain.col(i) += push;
    if (side == moving) sum.of_moving_wall += push.y();
  };
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    const V p = at.col(i);
    for (std::size_t side = 0; side < 4; ++side) {
      of_wall(i, static_cast<WallSide>(side), push_of_plane(p, points[side], normals[side]));
    }
    for (const WallGrain& grain : cell.wall_grains) {
      const V q = wall_grain_at(cell, walls, grain);
      of_wall(i, grain.side, push_of_images(p, q, cell.depth, false));
    }
    for (Eigen::Index j = 0; j < at.cols(); ++j) {
      sum.on_grain.col(i) += push_of_images(p, at.col(j), cell.depth, i == j);
    }
  }
  return sum;
}

void step_once(const Cell& cell, const Scene& scene, const Drive& drive, State& state) {
  const Angle tilt = angle(drive, scene.time_step, state.step);
  const Walls walls = walls_at(cell, tilt.value, state);
  const Pushes push = pushes(cell, walls, state.position);
  const double dt = scene.time_step, half = 0.5 * scene.drag_rate * dt;
  Eigen::Matrix3Xd force = scene.stiffness * push.on_grain;
  force.row(1).array() -= scene.gravity;
  if (scene.fluid == Fluid::cell) {
    const double rate = tilt.rate * (1 + walls.tangent * walls.tangent);
    force.row(0).array() += scene.drag_rate * rate * (state.position.row(1).array() - walls.top);
  }
  state.velocity = ((1 - half) * state.velocity + dt * force) / (1 + half);
  state.position += dt * state.velocity;
  const double area = cell.width * cell.depth;
  const double inwards = cell.moving == MovingWall::bottom ? 1 : -1;
  const double on_wall = inwards * scene.pressure * area - scene.stiffness * push.of_moving_wall;
  const double wall_half = 0.5 * scene.wall_drag * dt / scene.wall_mass;
  state.wall_velocity =
      ((1 - wall_half) * state.wall_velocity + dt * on_wall / (scene.wall_mass * area)) /
      (1 + wall_half);
  state.wall_height += dt * state.wall_velocity;
  ++state.step;
}

}  // namespace

void advance_all_pairs(const Cell& cell, const Scene& scene, const Drive& drive,
                       std::uint64_t steps, State& state) {
  for (std::uint64_t n = 0; n < steps; ++n) step_once(cell, scene, drive, state);
}

double fastest_vibration(const Cell& cell, const Scene& scene, const State& state) {
  std::vector<Contact> contacts;
  for_each_contact(cell, state.position, wall_pose(cell, 0, state.wall_height),
                   [&](const Contact& contact) { contacts.push_back(contact); });
  const Eigen::Index n = state.position.cols();
  Eigen::Matrix3Xd mode(3, n);
  for (Eigen::Index i = 0; i < mode.size(); ++i) {
    mode.data()[i] = std::sin(1.0 + 12.9898 * static_cast<double>(i * i));  // no symmetry
  }
  double square = 0;
  for (int iteration = 0; iteration < 3000; ++iteration) {
    mode /= mode.norm();
    Eigen::Matrix3Xd pull = Eigen::Matrix3Xd::Zero(3, n);
    for (const Contact& c : contacts) {
      V apart = mode.col(c.grain);
      if (c.kind == Contact::Kind::grain) apart -= mode.col(c.other);
      // The load of a contact of spheres turns with it; that of a plane does not.
      const double load = c.kind == Contact::Kind::wall_plane ? 0 : c.overlap / (1 - c.overlap);
      const V along = apart.dot(c.normal) * c.normal;
      const V back = along - load * (apart - along);
      pull.col(c.grain) += back;
      if (c.kind == Contact::Kind::grain) pull.col(c.other) -= back;
    }
    square = mode.cwiseProduct(pull).sum();
    mode = pull;
  }
  return std::sqrt(square * scene.stiffness);
}

double largest_difference(const State& a, const State& b) {
  return std::max((a.position - b.position).colwise().norm().maxCoeff(),
                  std::fabs(a.wall_height - b.wall_height));
}

}  // namespace shearcell::stability
