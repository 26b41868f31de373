// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/stability/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/minimizer.hpp"
#include "experiments/manifest/conversion.hpp"

namespace shearcell::stability {
namespace {

// The oracle: the contact law over all pairs and all images. Nothing of the engine is called here.

struct Pose {
  double tangent, bottom, top;
};

// Position of a wall grain: side walls tilt about the top wall, the others keep their shape.
V wall_grain_at(const Cell& cell, const Pose& walls, const WallGrain& grain) {
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

struct Pushes {
  Eigen::Matrix3Xd on_grain;
  double of_moving_wall = 0;  // upwards, on all grains
};

Pushes pushes(const Cell& cell, const Pose& walls, const Eigen::Matrix3Xd& at) {
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
      const double overlap = std::max(0.0, 0.5 - (p - points[side]).dot(normals[side]));
      of_wall(i, static_cast<WallSide>(side), overlap * normals[side]);
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
  const double dt = scene.time_step, area = cell.width * cell.depth;
  const bool bottom_moves = cell.moving == MovingWall::bottom;
  const std::uint64_t phase = state.step % (drive.steps_per_cycle + drive.pause_steps);
  const double amplitude = phase < drive.steps_per_cycle ? drive.amplitude : 0;
  const double turn = 2 * std::numbers::pi / static_cast<double>(drive.steps_per_cycle);
  const double at = turn * static_cast<double>(phase);
  const Pose walls{std::tan(amplitude * std::sin(at)),
                   bottom_moves ? state.wall_height : cell.bottom,
                   bottom_moves ? cell.top : state.wall_height};
  const Pushes push = pushes(cell, walls, state.position);
  Eigen::Matrix3Xd force = scene.stiffness * push.on_grain;
  force.row(1).array() -= scene.gravity;
  if (scene.fluid == Fluid::cell) {
    const double rate = amplitude * turn / dt * std::cos(at) * (1 + walls.tangent * walls.tangent);
    force.row(0).array() += scene.drag_rate * rate * (state.position.row(1).array() - walls.top);
  }
  const double half = 0.5 * scene.drag_rate * dt;
  state.velocity = ((1 - half) * state.velocity + dt * force) / (1 + half);
  state.position += dt * state.velocity;
  const double on_wall =
      (bottom_moves ? 1 : -1) * scene.pressure * area - scene.stiffness * push.of_moving_wall;
  const double wall_half = 0.5 * scene.wall_drag * dt / scene.wall_mass;
  state.wall_velocity =
      ((1 - wall_half) * state.wall_velocity + dt * on_wall / (scene.wall_mass * area)) /
      (1 + wall_half);
  state.wall_height += dt * state.wall_velocity;
  ++state.step;
}

}  // namespace

Scene table_1() {
  Parameters parameters;
  parameters.pressure_at = PressureAt::moving_wall;  // the closed forms have P A_w as the load
  return shear_scene(parameters);
}

Scene only_springs() {
  Scene scene = table_1();
  scene.drag_rate = scene.gravity = scene.pressure = 0;
  scene.wall_mass = 1e30;
  return scene;
}

Packing settled() {
  static const Packing packing = [] {
    Parameters parameters;
    parameters.grains = 60;
    parameters.pressure_at = PressureAt::moving_wall;
    Packing made = bench::settled_packing(parameters, 1);
    made.state = advanced(made, 20000);  // closer to rest than settling requires
    made.state.step = 0;
    return made;
  }();
  return packing;
}

Packing crystal(int layers, double overlap, int along, bool vacancy) {
  const double spacing = 1 - overlap, rise = spacing / std::numbers::sqrt2, end = 0.5 - overlap;
  std::vector<V> positions;
  for (int layer = 0; layer < layers; ++layer) {
    const int shift = layer % 2;  // every other layer sits in the hollows of its neighbours
    for (int column = 0; column < along - shift; ++column) {
      for (int k = 0; k < along; ++k) {
        positions.emplace_back(end + spacing * (column + 0.5 * shift), end + rise * layer,
                               spacing * (k + 0.5 * shift));
      }
    }
  }
  const V size(2 * end + spacing * (along - 1), 2 * end + rise * (layers - 1), spacing * along);
  if (vacancy) {
    positions.erase(
        std::ranges::min_element(positions, {}, [&](const V& p) { return (p - size / 2).norm(); }));
  }
  Packing made = placed(only_springs(), positions, size);
  // Each grain of the lowest layer is pressed onto the wall with k times the overlap.
  made.scene.pressure = made.scene.stiffness * overlap / (spacing * spacing);
  made.scene.wall_mass = 10;
  Simulation simulation = simulate(made);
  minimize_enthalpy(simulation, {.force_tolerance = 1e-9});
  made.state = simulation.state();
  made.state.step = 0;
  return made;
}

Packing in_fluid(Packing packing) {
  packing.scene.drag_rate = table_1().drag_rate;
  packing.scene.wall_drag = table_1().wall_drag;
  return packing;
}

void disturb(State& state, const V& speed) {
  for (Eigen::Index i = 0; i < state.velocity.size(); ++i) {
    state.velocity.data()[i] = speed(i % 3) * std::sin(7.0 * static_cast<double>(i * i));
  }
  state.velocity.row(2).array() -= state.velocity.row(2).mean();
}

Packing row_between_walls(int count, const Scene& scene) {
  std::vector<V> positions;
  for (int i = 0; i < count; ++i) positions.emplace_back(0.7 + 1.2 * i, 0.5, 1.5);
  return placed(scene, positions, {4, 1, 3});
}

double kinetic_energy(const State& state) {
  return 0.5 * state.velocity.squaredNorm() / static_cast<double>(state.velocity.cols());
}

double largest_difference(const State& a, const State& b) {
  return std::max((a.position - b.position).colwise().norm().maxCoeff(),
                  std::fabs(a.wall_height - b.wall_height));
}

Answer expect_stop(const Packing& packing, std::uint64_t steps, const std::string& quantity) {
  Simulation simulation = simulate(packing);
  try {
    simulation.advance(Drive{}, steps);
  } catch (const NumericalFailure& failure) {
    return {failure.quantity.find(quantity) != std::string::npos,
            fmt::format("stopped at step {}: {} is {:.4g}, limit {:.4g}", failure.step,
                        failure.quantity, failure.value, failure.limit)};
  }
  return {false, fmt::format("not stopped in {} steps; kinetic energy per grain {:.3g}", steps,
                             kinetic_energy(simulation.state()))};
}

Answer expect_near(const std::string& what, double got, double right, double tolerance) {
  const double off = std::fabs(got - right);
  return {off <= tolerance, fmt::format("{} {:.9g}, right {:.9g}, off by {:.2g} (of {:.2g})", what,
                                        got, right, off, tolerance)};
}

Answer expect_at_most(const std::string& what, double got, double most) {
  return {got <= most, fmt::format("{} {:.2g} (at most {:.2g})", what, got, most)};
}

Answer expect_as_all_pairs(const Packing& packing, const State& end, const Drive& drive,
                           double tolerance) {
  State right = packing.state;
  while (right.step < end.step) step_once(packing.cell, packing.scene, drive, right);
  return expect_at_most("difference from the sum over all pairs", largest_difference(end, right),
                        tolerance);
}

Answer expect_balance(const Packing& packing, const State& state, double most) {
  return expect_at_most("largest net force / P d^2",
                        force_residual(packing.cell, packing.scene, state), most);
}

Answer all_of(const std::vector<Answer>& parts) {
  Answer whole{true, ""};
  for (const Answer& part : parts) {
    whole.as_expected = whole.as_expected && part.as_expected;
    whole.text += (whole.text.empty() ? "" : "; ") + part.text;
  }
  return whole;
}

}  // namespace shearcell::stability
