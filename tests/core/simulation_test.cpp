// SPDX-License-Identifier: GPL-3.0-or-later
// The time loop against closed forms and conservation laws.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/diagnostics.hpp"
#include "core/random.hpp"
#include "core/simulation.hpp"
#include "tests/core/scenes.hpp"

namespace shearcell {
namespace {

using test::at_rest;
using test::only_contacts;
using test::open_cell;
using test::table_1;

// Two grains that just touch and approach at relative speed v: while they touch, the overlap is
// (v/w) sin(w t) with w^2 = 2k/m. Largest error of it over the first half of the contact.
double collision_error(int steps_per_contact) {
  Scene scene = only_contacts();
  const double omega = std::sqrt(2 * scene.stiffness);
  scene.time_step = std::numbers::pi / omega / steps_per_contact;
  const Cell cell = open_cell();
  State state = at_rest({{20, 20, 20}, {21, 20, 20}}, cell);
  const double v = 10;
  // At half a step before the touch both are free.
  state.position(0, 0) = 20;
  state.velocity(0, 0) = v / 2;
  state.velocity(0, 1) = -v / 2;
  Simulation simulation(cell, scene, state);
  double worst = 0;
  for (int n = 1; n < steps_per_contact / 2; ++n) {
    simulation.advance(Drive{}, 1);
    const Eigen::Matrix3Xd p = simulation.state().position;
    const double overlap = 1 - (p.col(1) - p.col(0)).norm();
    const double exact = v / omega * std::sin(omega * scene.time_step * n);
    worst = std::max(worst, std::fabs(overlap - exact) / (v / omega));
  }
  return worst;
}

TEST(Collision, FollowsTheHarmonicContactAtSecondOrder) {
  const double coarse = collision_error(50);
  const double fine = collision_error(200);
  std::printf("error of the overlap: %.3g at 50, %.3g at 200 steps a contact\n", coarse, fine);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_NEAR(std::log2(coarse / fine) / 2, 2, 0.25);
}

TEST(Collision, ExchangesVelocitiesAndConservesMomentum) {
  Scene scene = only_contacts();
  scene.time_step /= 10;
  const Cell cell = open_cell();
  // Across the periodic seam, and oblique.
  State state = at_rest({{20, 20, 39.6}, {20, 20, 0.7}}, cell);
  state.velocity.col(0) << 0, 0, 5;
  state.velocity.col(1) << 0, 0, -3;
  Simulation simulation(cell, scene, state);
  simulation.advance(Drive{}, 20000);
  const Eigen::Matrix3Xd v = simulation.state().velocity;
  // Where within a step the contact begins and ends changes the speed by order dt.
  EXPECT_NEAR(v(2, 0), -3, 2e-3);
  EXPECT_NEAR(v(2, 1), 5, 2e-3);
  EXPECT_NEAR(v(2, 0) + v(2, 1), 2, 1e-13);
}

TEST(FreeFall, ReachesTheTerminalVelocityOfStokesDrag) {
  Scene scene = table_1();
  scene.pressure = 0;
  const Cell cell = open_cell(400);
  Simulation simulation(cell, scene, at_rest({{200, 390, 1}}, cell));
  for (int n = 0; n < 20; ++n) {
    simulation.advance(Drive{}, 100);
    // At rest half a step before the first: the stored velocity is that after `step` whole steps.
    const double t = static_cast<double>(simulation.step()) * scene.time_step;
    const double exact = -scene.gravity / scene.drag_rate * (1 - std::exp(-scene.drag_rate * t));
    EXPECT_NEAR(simulation.state().velocity(1, 0), exact, 1e-6 * std::fabs(exact)) << t;
  }
  simulation.advance(Drive{}, 20000);
  EXPECT_NEAR(simulation.state().velocity(1, 0), -scene.gravity / scene.drag_rate, 1e-9);
}

TEST(Fluid, CarriesALoneGrainAlong) {
  // m v' = -b (v - U cos(w t)): amplitude U b / sqrt(b^2 + w^2), and the phase lags.
  Scene scene = only_contacts();
  scene.drag_rate = 64;
  scene.fluid = Fluid::cell;
  scene.time_step = 2.0 / 4560;
  const Cell cell = open_cell();
  const double amplitude = 1e-3, depth_below_top = 15;
  Simulation simulation(cell, scene, at_rest({{20, 40 - depth_below_top, 20}}, cell));
  const Drive drive{amplitude, 4560, 0};
  simulation.advance(drive, 4560);
  const double omega = std::numbers::pi, b = scene.drag_rate;
  const double gain = b / std::sqrt(b * b + omega * omega), lag = std::atan(omega / b);
  for (int n = 0; n < 8; ++n) {
    simulation.advance(drive, 570);
    const double t = (static_cast<double>(simulation.step()) - 0.5) * scene.time_step;
    const double exact = -depth_below_top * amplitude * omega * gain * std::cos(omega * t - lag);
    EXPECT_NEAR(simulation.state().velocity(0, 0), exact,
                2e-3 * depth_below_top * amplitude * omega);
  }
}

TEST(Wall, WithoutGrainsMovesAtPressureOverDrag) {
  for (const MovingWall moving : {MovingWall::bottom, MovingWall::top}) {
    Scene scene = table_1();
    scene.gravity = 0;
    Cell cell = open_cell(400);
    cell.moving = moving;
    Simulation simulation(cell, scene, at_rest({{200, 200, 20}}, cell));
    simulation.advance(Drive{}, 10000);
    const double sign = moving == MovingWall::bottom ? 1 : -1;
    EXPECT_NEAR(simulation.state().wall_velocity, sign * scene.pressure / scene.wall_drag, 1e-9);
  }
}

TEST(Wall, CarriesAGrainAtTheOverlapThatItsWeightNeeds) {
  Scene scene = table_1();
  scene.pressure = 0;
  scene.wall_mass = 1e30;  // does not stir
  const Cell cell = open_cell();
  Simulation simulation(cell, scene, at_rest({{20, 0.5, 20}}, cell));
  simulation.advance(Drive{}, 20000);
  const double overlap = 0.5 - simulation.state().position(1, 0);
  EXPECT_NEAR(overlap, scene.gravity / scene.stiffness, 1e-12);
}

TEST(Wall, TiltedPlanesPushAlongTheirNormals) {
  const Cell cell = open_cell();
  const double theta = 0.1;
  const WallPose pose = wall_pose(cell, theta, 0);
  // 0.49 d from the left plane, along its normal.
  const Eigen::Vector3d foot((10 - pose.top) * std::tan(theta), 10, 20);
  const Eigen::Vector3d normal(std::cos(theta), -std::sin(theta), 0);
  const State state = at_rest({foot + 0.49 * normal}, cell);
  int touches = 0;
  for_each_contact(cell, state.position, pose, [&](const Contact& contact) {
    ++touches;
    EXPECT_EQ(contact.kind, Contact::Kind::wall_plane);
    EXPECT_EQ(contact.side, WallSide::left);
    EXPECT_NEAR(contact.overlap, 0.01, 1e-14);
    EXPECT_LT((contact.normal - normal).norm(), 1e-15);
  });
  EXPECT_EQ(touches, 1);
}

// A ball of overlapping grains flies apart: nothing outside acts, so momentum stays 0 to rounding,
// and the energy of the springs becomes kinetic.
TEST(Contacts, BalanceMomentumAndEnergy) {
  Scene scene = only_contacts();
  scene.time_step /= 4;
  const Cell cell = open_cell();
  std::vector<Eigen::Vector3d> positions;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const auto a = uniform_pair({i, 0, 0, 0}, 1);
    const auto b = uniform_pair({i, 1, 0, 0}, 1);
    // A jittered simple cubic block at 0.96 d, straddling the seam.
    const std::uint32_t x = i % 4, y = i / 4 % 4, z = i / 16;
    positions.emplace_back(18 + 0.96 * x + 0.02 * a[0], 18 + 0.96 * y + 0.02 * a[1],
                           38.5 + 0.96 * z + 0.02 * b[0]);
  }
  const State state = at_rest(positions, cell);
  const WallPose pose = wall_pose(cell, 0, 0);
  const auto spring_energy = [&](const State& s) {
    double energy = 0;
    for_each_contact(cell, s.position, pose, [&](const Contact& c) {
      energy += 0.5 * scene.stiffness * c.overlap * c.overlap;
    });
    return energy;
  };
  const double before = spring_energy(state);
  ASSERT_GT(before, 0);
  Simulation simulation(cell, scene, state);
  simulation.advance(Drive{}, 4000);
  const State after = simulation.state();
  const Eigen::Vector3d momentum = after.velocity.rowwise().sum();
  const double scale = after.velocity.cwiseAbs().sum();
  EXPECT_LT(momentum.norm(), 1e-13 * scale);
  const double energy = spring_energy(after) + 0.5 * after.velocity.squaredNorm();
  EXPECT_NEAR(energy / before, 1, 2e-3);
}

}  // namespace
}  // namespace shearcell
