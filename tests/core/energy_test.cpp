// SPDX-License-Identifier: GPL-3.0-or-later
// The energy balance of a driven cell: the work of the tilting walls and of the fluid is the change
// of elastic, kinetic and gravitational energy and of the load's energy, plus the dissipation, up
// to an error of the integrator's order.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/diagnostics.hpp"
#include "core/simulation.hpp"
#include "tests/core/scenes.hpp"

namespace shearcell {
namespace {

using test::Sheared;
using test::table_1;

constexpr double kPeriod = 0.05;  // [s]
constexpr double kAmplitude = 0.1;

// Elastic energy of all contacts with the walls in a pose, and the force of the contacts on the
// moving wall.
struct Springs {
  double energy = 0, on_wall = 0;
};

Springs springs(const Cell& cell, const Scene& scene, const State& state, const WallPose& pose) {
  Springs sum;
  for_each_contact(cell, state.position, pose, [&](const Contact& c) {
    sum.energy += 0.5 * scene.stiffness * c.overlap * c.overlap;
    const bool of_wall = c.kind != Contact::Kind::grain && c.side == moving_side(cell);
    if (of_wall) sum.on_wall -= scene.stiffness * c.overlap * c.normal.y();
  });
  return sum;
}

// Work of the walls as they go from one pose to the other past resting grains, less what the moving
// wall gains by its own motion.
double work_of_walls(const Cell& cell, const Scene& scene, const State& state, const WallPose& from,
                     const WallPose& to) {
  const Springs a = springs(cell, scene, state, from), b = springs(cell, scene, state, to);
  const double rise = (to.bottom - from.bottom) + (to.top - from.top);
  return b.energy - a.energy + 0.5 * (a.on_wall + b.on_wall) * rise;
}

// Energy except that of the springs, with the velocities of the whole step between two half steps.
double other_energy(const Cell& cell, const Scene& scene, const State& before, const State& after) {
  const double area = cell.width * cell.depth;
  const Eigen::Matrix3Xd v = 0.5 * (before.velocity + after.velocity);
  const double wall = 0.5 * (before.wall_velocity + after.wall_velocity);
  const auto grains = static_cast<std::size_t>(v.cols());
  const double load = scene.pressure * area + carried_weight(scene, cell, grains);
  return 0.5 * v.squaredNorm() + 0.5 * scene.wall_mass * area * wall * wall +
         scene.gravity * before.position.row(1).sum() - inwards(cell) * load * before.wall_height;
}

struct Ledger {
  double change = 0, walls = 0, dissipated = 0;
  double missing() const { return change + dissipated - walls; }
};

// Over half a cycle, from the first whole step with a velocity on both sides.
Ledger ledger(const Sheared& start, Scene scene, int finer) {
  const double steps_per_period = std::round(kPeriod / scene.time_step) * finer;
  scene.time_step = kPeriod / steps_per_period;
  const Drive drive{kAmplitude, static_cast<std::uint64_t>(steps_per_period), 0};
  const Cell& cell = start.cell;
  Simulation simulation(cell, scene, start.state);
  const auto pose = [&](const State& state) {
    return wall_pose(cell, tilt(drive, state.step).theta, state.wall_height);
  };
  simulation.advance(drive, 1);
  State here = simulation.state();
  double energy_before = 0;
  Ledger sum;
  for (std::uint64_t step = 1; step <= drive.steps_per_cycle / 2; ++step) {
    simulation.advance(drive, 1);
    const State next = simulation.state();
    // `here` holds the positions of this step, `next` the velocities half a step later.
    const double energy =
        other_energy(cell, scene, here, next) + springs(cell, scene, here, pose(here)).energy;
    if (step == 1) energy_before = energy;
    sum.change = energy - energy_before;
    if (step == drive.steps_per_cycle / 2) break;
    const double h = scene.time_step;
    sum.walls += 0.5 * (work_of_walls(cell, scene, here, pose(here), pose(next)) +
                        work_of_walls(cell, scene, next, pose(here), pose(next)));
    Eigen::Matrix3Xd relative = next.velocity;
    if (scene.fluid == Fluid::cell) {
      const double top = 0.5 * (pose(here).top + pose(next).top);
      const double rate = (pose(next).tan_theta - pose(here).tan_theta) / h;
      relative.row(0).array() -=
          rate * (0.5 * (here.position.row(1) + next.position.row(1)).array() - top);
    }
    sum.dissipated += h * scene.drag_rate * next.velocity.cwiseProduct(relative).sum();
    sum.dissipated +=
        h * scene.wall_drag * cell.width * cell.depth * next.wall_velocity * next.wall_velocity;
    here = next;
  }
  return sum;
}

TEST(Energy, OfADrivenCellIsBalanced) {
  struct Case {
    const char* name;
    MovingWall moving;
    PressureAt at;
    Fluid fluid;
  };
  for (const Case& c :
       {Case{"bottom", MovingWall::bottom, PressureAt::moving_wall, Fluid::still},
        Case{"bottom, P at the top, fluid moves", MovingWall::bottom, PressureAt::top, Fluid::cell},
        Case{"top", MovingWall::top, PressureAt::moving_wall, Fluid::still}}) {
    const Sheared start = test::pressed(80, 15000, WallTexture::rough, c.moving);
    Scene scene = table_1();
    scene.pressure_at = c.at;
    scene.fluid = c.fluid;
    double error[2];
    for (int n = 0; n < 2; ++n) {
      const int finer = n == 0 ? 1 : 4;
      const Ledger sum = ledger(start, scene, finer);
      error[n] = std::fabs(sum.missing()) / sum.dissipated;
      std::printf(
          "%s, dt/%d: walls %.6g, dissipated %.6g, stored %.6g, missing %.2g of dissipated\n",
          c.name, finer, sum.walls, sum.dissipated, sum.change, error[n]);
    }
    EXPECT_LT(error[0], 0.05) << c.name;
    EXPECT_LT(error[1], error[0] / 8) << c.name << ": second order gives 1/16";
  }
}

}  // namespace
}  // namespace shearcell
