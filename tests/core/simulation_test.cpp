// SPDX-License-Identifier: GPL-3.0-or-later
// The time loop against closed forms. More of them: tests/hard and
// tests/bench/closed_forms.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/diagnostics.hpp"
#include "core/simulation.hpp"
#include "tests/core/scenes.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

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

TEST(Fluid, CarriesASingleGrain) {
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

}  // namespace
}  // namespace shearcell
