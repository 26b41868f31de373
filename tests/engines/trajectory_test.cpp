// SPDX-License-Identifier: GPL-3.0-or-later
// One packing in our engine and in LAMMPS: after 200 steps under shear every grain and the moving
// wall are at the same place, in every scene. Rounding alone gives 1e-12 d.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "experiments/bench/packing.hpp"
#include "experiments/manifest/conversion.hpp"
#include "tests/support/run_lammps.hpp"

namespace shearcell::test {
namespace {

struct Case {
  const char* name;
  std::function<void(Parameters&)> change;
  std::size_t ranks = 1;
  std::uint64_t from = 500;  // the first of the 200 steps; a cycle has 10000
};

void PrintTo(const Case& scene, std::ostream* out) {
  *out << scene.name;
}

// A pressed packing after some steps of the scene's own shear.
LammpsTask task_of(const Case& scene) {
  // Walls that move fast.
  Parameters p{.grains = 300, .amplitude_rad = 0.1, .period_s = 0.5, .steps_per_cycle = 10000};
  scene.change(p);
  Parameters pressing = p;
  pressing.drag_kg_per_s = Parameters{}.drag_kg_per_s;
  const bench::Packing packing = bench::pressed_packing(pressing, 1);
  LammpsTask task{.cell = packing.cell, .scene = shear_scene(p), .drive = drive(p), .state = {}};
  Simulation simulation(task.cell, task.scene, packing.state);
  simulation.advance(task.drive, scene.from);
  task.state = simulation.state();
  task.end = task.state.step + 200;
  task.stride = 1'000'000;
  return task;
}

class LammpsTrajectory : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    if (!find_program("lmp")) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
    if (GetParam().ranks > 1 && !find_program("mpirun")) {
      GTEST_SKIP() << "needs mpirun (Debian package openmpi-bin)";
    }
  }
};

TEST_P(LammpsTrajectory, AgreesWithOurs) {
  const LammpsTask task = task_of(GetParam());
  const State theirs = run_lammps(find_lammps(), task, GetParam().ranks).state;
  Simulation simulation(task.cell, task.scene, task.state);
  simulation.advance(task.drive, 200);
  const State ours = simulation.state();
  const double apart = (ours.position - theirs.position).colwise().norm().maxCoeff();
  const double moved = (ours.position - task.state.position).colwise().norm().maxCoeff();
  std::printf("moved %.2g d, apart %.2g d, the wall %.2g d\n", moved, apart,
              std::fabs(ours.wall_height - theirs.wall_height));
  EXPECT_EQ(theirs.step, task.end);
  EXPECT_GT(moved, 0.01);
  EXPECT_LT(apart, 1e-9);
  EXPECT_LT(std::fabs(ours.wall_height - theirs.wall_height), 1e-10);
  const double faster = (ours.velocity - theirs.velocity).colwise().norm().maxCoeff();
  EXPECT_LT(faster, 1e-5);  // d/s, beside some 10 d/s
  EXPECT_LT(std::fabs(ours.wall_velocity - theirs.wall_velocity), 1e-6);
}

void top(Parameters& p) {
  p.moving_wall = MovingWall::top;
}

void pause(Parameters& p) {
  p.fluid = Fluid::cell;
  p.protocol = ProtocolKind::paused;
  p.pause_s = 0.01;
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, LammpsTrajectory,
    testing::Values(Case{"TableI", [](Parameters&) {}}, Case{"TopMoves", top},
                    Case{"PressureAtTop", [](Parameters& p) { p.pressure_at = PressureAt::top; }},
                    Case{"Smooth", [](Parameters& p) { p.walls = WallTexture::smooth; }},
                    Case{"SmoothTop",
                         [](Parameters& p) {
                           top(p);
                           p.walls = WallTexture::smooth;
                         }},
                    Case{"NoGravity", [](Parameters& p) { p.gravity_m_per_s2 = 0; }},
                    Case{"NoDrag", [](Parameters& p) { p.drag_kg_per_s = 0; }},
                    Case{"NoDragAtAll",
                         [](Parameters& p) { p.drag_kg_per_s = p.wall_drag_grains_per_d2_s = 0; }},
                    Case{"MovingFluid", [](Parameters& p) { p.fluid = Fluid::cell; }},
                    Case{"MovingFluidTop",
                         [](Parameters& p) {
                           top(p);
                           p.fluid = Fluid::cell;
                         }},
                    Case{"BeginningOfAPause", pause, 1, 9900}, Case{"EndOfAPause", pause, 1, 10100},
                    Case{"TwoProcesses", [](Parameters& p) { p.fluid = Fluid::cell; }, 2}),
    [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace shearcell::test
