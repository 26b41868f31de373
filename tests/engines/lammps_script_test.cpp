// SPDX-License-Identifier: GPL-3.0-or-later
// The exported script with the changes that its comments invite: LAMMPS must then compute what
// mechanics says in closed form. $SHEARCELL_LAMMPS names another LAMMPS.
#include "tests/support/lammps_script.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "provenance/io/child_process.hpp"
#include "tests/support/packing.hpp"

namespace shearcell::test {
namespace {

using std::numbers::pi;

constexpr Units kUnits{.diameter_m = 3e-3, .mass_kg = 2e-5};

class LammpsScript : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_program(lammps_name())) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  }

  void write(const LammpsTask& task) {
    const WallPose pose =
        wall_pose(task.cell, tilt(task.drive, task.state.step).theta, task.state.wall_height);
    write_output(folder_.path() / "grains.data",
                 lammps_data(particles_of(task.cell, pose, task.state, 0, task.units), "grains"));
    script_ = lammps_script(task, "grains.data", "grains");
  }

  void replace(const std::string& what, const std::string& by) {
    const auto at = script_.find(what);
    ASSERT_NE(at, script_.npos) << what << "\n" << script_;
    script_.replace(at, what.size(), by);
  }

  /// The line of a comment that begins so, without its #.
  std::string example(const std::string& begins) {
    const auto at = script_.find("# " + begins);
    EXPECT_NE(at, script_.npos) << begins;
    return script_.substr(at + 2, script_.find('\n', at) - at - 2);
  }

  /// Every particle after so many steps.
  DumpFrame after(std::uint64_t steps, std::vector<std::string> options = {}) {
    write_output(folder_.path() / "in.grains", script_);
    const std::string number = std::to_string(steps);
    options.insert(options.end(), {"-var", "steps", number, "-var", "every", number});
    run_script(folder_.path(), "in.grains", options);
    return last_frame(folder_.path() / "grains.lammpstrj");
  }

  TemporaryFolder folder_;
  std::string script_;
};

Scene bare() {
  return {.stiffness = 654 / kUnits.mass_kg, .wall_mass = 1e6, .wall_drag = 0, .time_step = 2e-5};
}

// A grain at rest is put on a bottom plane of speed V(t). It slides, at v = mu g t, until v +
// omega r = V; as the friction f gives m v' = f and (2/5) m r^2 omega' = r f, omega r = 5/2 v
// always, and it rolls with v = 2/7 V(t) thereafter, however the plane accelerates.
TEST_F(LammpsScript, AGrainSlidesAndThenRollsOnAnAcceleratingPlane) {
  const double g = 9.81, mu = 0.5, amplitude = 0.3, period = 0.3, height = 10;
  for (const MovingWall moving : {MovingWall::bottom, MovingWall::top}) {
    Scene scene = bare();
    scene.gravity = g / kUnits.diameter_m;
    scene.pressure_at = PressureAt::moving_wall;
    Packing made = placed(scene, {{15, 0.5 - scene.gravity / scene.stiffness, 2}}, {30, height, 5});
    made.cell.moving = moving;
    made.state.wall_height = moving == MovingWall::top ? height : 0;
    const auto turn = static_cast<std::uint64_t>(std::lround(period / scene.time_step));
    write({.cell = made.cell,
           .scene = scene,
           .drive = {.amplitude = amplitude, .steps_per_cycle = turn},
           .state = made.state,
           .units = kUnits});
    const std::vector<std::string> law = {"-var", "law", example("hooke ")};
    const auto plane = [&](double t) {
      const double w = 2 * pi / period, theta = amplitude * std::sin(w * t);
      return -height * kUnits.diameter_m * amplitude * w * std::cos(w * t) /
             std::pow(std::cos(theta), 2);
    };
    const double rolls = 2.0 / 7 * std::fabs(plane(0)) / (mu * g);
    const double radius = kUnits.diameter_m / 2;
    for (const double t : {rolls / 2, 0.1, 0.15, 0.22}) {
      const auto steps = static_cast<std::uint64_t>(std::lround(t / scene.time_step));
      const DumpFrame end = after(steps, law);
      const double at = static_cast<double>(steps) * scene.time_step;
      const double expected = t < rolls ? -mu * g * at : 2.0 / 7 * plane(at);
      const double speed = end.at("vx")[0], spin = end.at("omegaz")[0] * radius;
      std::printf("t = %.3f s: v = %.5f, omega r = %.5f, expected %.5f and %.5f m/s\n", at, speed,
                  spin, expected, 2.5 * expected);
      EXPECT_NEAR(speed, expected, 0.01 * std::fabs(plane(0)) * 2 / 7);
      EXPECT_NEAR(spin, 2.5 * speed, 1e-3 * std::fabs(plane(0)));
    }
  }
}

// A grain at rest that a spring k presses by s leaves it with s sqrt(k/m).
TEST_F(LammpsScript, GrainsOfTwoSizesTouchEachPlaneWithTheirOwnRadius) {
  const double press = 0.01, amplitude = 0.2, small = 0.8;
  const Eigen::Vector3d size(20, 10, 5);
  for (const MovingWall moving : {MovingWall::bottom, MovingWall::top}) {
    const Scene scene = bare();
    Packing made = placed(scene, std::vector<Eigen::Vector3d>(8), size);
    made.cell.moving = moving;
    made.state.wall_height = moving == MovingWall::top ? size.y() : 0;
    // At rest at the largest tilt of a slow cycle.
    const Drive drive{.amplitude = amplitude, .steps_per_cycle = 4'000'000'000};
    made.state.step = drive.steps_per_cycle / 4;
    const auto planes =
        wall_planes(made.cell, wall_pose(made.cell, amplitude, made.state.wall_height));
    const double middle[4][2] = {{0, 5}, {0, 5}, {6, 0}, {6, 0}};
    Eigen::Matrix3Xd normal = Eigen::Matrix3Xd::Zero(3, 8);
    for (Eigen::Index i = 0; i < 8; ++i) {
      const WallPlane& plane = planes[static_cast<std::size_t>(i % 4)];
      Eigen::Vector3d r(middle[i % 4][0], middle[i % 4][1], i < 4 ? 1 : 3.5);
      normal.col(i).head<2>() << plane.normal[0], plane.normal[1];
      if (i % 4 < 2)
        r.x() = plane.point[0] - (r.y() - plane.point[1]) * plane.normal[1] / plane.normal[0];
      if (i % 4 >= 2) r.y() = plane.point[1];
      made.state.position.col(i) = r + ((i < 4 ? 1 : small) / 2 - press) * normal.col(i);
    }
    write(
        {.cell = made.cell, .scene = scene, .drive = drive, .state = made.state, .units = kUnits});
    std::string change = example("set atom ");
    change.replace(change.find("1*50"), 4, "5*8");
    replace("# " + example("set atom "), change);
    const DumpFrame end = after(100);
    const Eigen::Matrix3Xd v = three(end, "vx", "vy", "vz");
    for (Eigen::Index i = 0; i < 8; ++i) {
      const double mass = i < 4 ? 1 : std::pow(small, 3);
      const double expected = press * kUnits.diameter_m * std::sqrt(scene.stiffness / mass);
      EXPECT_NEAR(end.at("diameter")[i], (i < 4 ? 1 : small) * kUnits.diameter_m, 1e-9);
      EXPECT_NEAR(v.col(i).dot(normal.col(i)), expected, 5e-3 * expected) << i;
      EXPECT_NEAR(v.col(i).norm(), expected, 5e-3 * expected) << i;
    }
  }
}

// A damped spring returns the share exp(-pi c / sqrt(k/m - c^2)) of the speed, c = gamma/2, from
// whatever cannot move.
TEST_F(LammpsScript, PlanesAndWallGrainsAreImmovableInCollisions) {
  Packing made = placed(bare(), {{5, 2.5, 2}, {12, 2.5, 2}}, {20, 10, 5});
  made.cell.wall_grains = {{WallSide::bottom, {5, 0.5, 2}}};
  made.state.velocity.row(1).setConstant(-20);  // d/s, 1 and 2 d above what they meet
  write(
      {.cell = made.cell, .scene = made.scene, .drive = {}, .state = made.state, .units = kUnits});
  std::string law = example("hooke ");
  law.replace(law.find(" 50 "), 4, " 2000 ");
  const DumpFrame end = after(10000, {"-var", "law", law});
  const double c = 1000, share = std::exp(-pi * c / std::sqrt(made.scene.stiffness - c * c));
  for (const int i : {0, 1}) {
    EXPECT_NEAR(end.at("vy")[i] / (20 * kUnits.diameter_m), share, 0.02) << i;
  }
}

// In a smooth cell nothing but the planes of top and bottom bears load.
TEST_F(LammpsScript, TheWallsBearThePressureAndThePresentWeight) {
  for (const MovingWall moving : {MovingWall::bottom, MovingWall::top}) {
    Parameters p{.grains = 100, .walls = WallTexture::smooth, .moving_wall = moving};
    const Packing made = settled_packing(p, 1);
    write({.cell = made.cell,
           .scene = shear_scene(p),
           .drive = {},
           .state = made.state,
           .units = kUnits});
    const double density = 4 * kUnits.mass_kg / (pi / 6 * std::pow(kUnits.diameter_m, 3));
    replace("# " + example("set atom "), fmt::format("set group grains density {:.17g}", density));
    const DumpFrame end = after(static_cast<std::uint64_t>(0.5 / shear_scene(p).time_step));
    const auto wall = end.at("y").size() - 1;  // the atom of the moving wall has the last id
    ASSERT_EQ(end.at("type")[wall], 6);
    const double moved = end.at("y")[wall], d = kUnits.diameter_m, g = p.gravity_m_per_s2;
    const double low = moving == MovingWall::bottom ? moved : made.cell.bottom * d;
    const double high = moving == MovingWall::top ? moved : made.cell.top * d;
    double on_bottom = 0, on_top = 0;
    for (Eigen::Index i = 0; i < wall; ++i) {
      const double y = end.at("y")[i];
      on_bottom += p.stiffness_N_per_m * std::max(0.0, d / 2 - (y - low));
      on_top += p.stiffness_N_per_m * std::max(0.0, d / 2 - (high - y));
    }
    const double load = p.pressure_Pa * made.cell.width * made.cell.depth * d * d;
    const double weight = 100 * 4 * kUnits.mass_kg * g;
    std::printf("top %.4f N, bottom %.4f N, expected %.4f N and %.4f N\n", on_top, on_bottom, load,
                load + weight);
    EXPECT_NEAR(on_top, load, 0.002 * load);
    EXPECT_NEAR(on_bottom, load + weight, 0.002 * load);
  }
}

// Twice as many steps of half the length are the same motion of the walls and of the grains.
TEST_F(LammpsScript, TakesFinerSteps) {
  Parameters p{.grains = 100, .steps_per_cycle = 20000};
  const Packing made = settled_packing(p, 1);
  LammpsTask task{.cell = made.cell,
                  .scene = shear_scene(p),
                  .drive = drive(p),
                  .state = made.state,
                  .units = kUnits};
  task.state.step = p.steps_per_cycle;
  Simulation simulation(task.cell, task.scene, task.state);
  write(task);
  const DumpFrame coarse = after(100), fine = after(400, {"-var", "finer", "4"});
  ASSERT_EQ(coarse.at("x").size(), fine.at("x").size());
  const Eigen::Matrix3Xd there = three(coarse, "x", "y", "z"), here = three(fine, "x", "y", "z");
  const double apart = (there - here).colwise().norm().maxCoeff() / kUnits.diameter_m;
  const double moved =
      (there.leftCols(100) / kUnits.diameter_m - task.state.position).colwise().norm().maxCoeff();
  std::printf("moved %.2g d, apart %.2g d\n", moved, apart);
  EXPECT_LT(apart, 0.02 * moved);
}

}  // namespace
}  // namespace shearcell::test
