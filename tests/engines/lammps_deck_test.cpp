// SPDX-License-Identifier: GPL-3.0-or-later
// The input that LAMMPS gets, and the reading of its output. Does not need LAMMPS.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/lammps/lammps_deck.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/packing.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

LammpsTask loose_task(const Parameters& p) {
  const Packing packing = loose_packing(p, 1);
  return {.cell = packing.cell,
          .scene = shear_scene(p),
          .drive = drive(p),
          .state = packing.state,
          .end = 100};
}

Parameters small() {
  return {.grains = 100, .pressure_at = PressureAt::moving_wall};
}

// The number behind a piece of text.
double number_after(const std::string& text, const std::string& words) {
  const auto at = text.find(words);
  EXPECT_NE(at, std::string::npos) << words;
  return at == std::string::npos ? 0 : std::stod(text.substr(at + words.size()));
}

TEST(LammpsDeck, RaisesMassesByTheDragAndKeepsWeight) {
  const LammpsTask task = loose_task(small());
  const std::string deck = lammps_deck(task);
  const double b = task.scene.drag_rate, dt = task.scene.time_step;
  const double mass = 1 + b * dt / 2;
  const double area = task.cell.width * task.cell.depth;
  EXPECT_DOUBLE_EQ(number_after(deck, "set group grains mass "), mass);
  EXPECT_TRUE(has(deck, fmt::format("set group wall mass $({:.17g}+{:.17g}*dt/2:%.17g)\n",
                                    area * task.scene.wall_mass, area * task.scene.wall_drag)));
  EXPECT_DOUBLE_EQ(number_after(deck, "fix weight grains gravity ") * mass, task.scene.gravity);
  EXPECT_DOUBLE_EQ(number_after(deck, "fix drag grains viscous "), b);
  EXPECT_DOUBLE_EQ(number_after(deck, "variable push equal "), task.scene.pressure * area);
  EXPECT_DOUBLE_EQ(number_after(lammps_deck(loose_task({.grains = 100})), "variable push equal "),
                   task.scene.pressure * area + 100 * task.scene.gravity);
}

TEST(LammpsDeck, LeavesOutWhatTheSceneDoesNotHave) {
  Parameters p = small();
  p.gravity_m_per_s2 = 0;
  p.drag_kg_per_s = 0;
  p.amplitude_rad = 0;
  p.walls = WallTexture::smooth;
  const std::string deck = lammps_deck(loose_task(p));
  for (const char* part : {"gravity", "fix drag", "fix flow", "theta", "move variable", "fcm"}) {
    EXPECT_FALSE(has(deck, part)) << part;
  }
  EXPECT_EQ(number_after(deck, "set group grains mass "), 1);
}

TEST(LammpsDeck, FollowsTheMovingWall) {
  Parameters p = small();
  const LammpsTask below = loose_task(p);
  const std::string bottom = lammps_deck(below);
  const auto wall = [](const LammpsTask& of) { return 101 + of.cell.wall_grains.size(); };
  EXPECT_TRUE(has(bottom, fmt::format("variable bottom equal y[{}]\n", wall(below))));
  EXPECT_TRUE(has(bottom, "f_bottom_plane[1]+fcm(bottom,y)\n"));
  EXPECT_FALSE(has(bottom, "fix top top move"));
  p.moving_wall = MovingWall::top;
  const LammpsTask task = loose_task(p);
  const std::string top = lammps_deck(task);
  EXPECT_TRUE(has(top, fmt::format("variable top equal y[{}]\n", wall(task))));
  EXPECT_TRUE(has(top, "fix top top move"));
  EXPECT_LT(number_after(top, "variable push equal "), 0) << "the pressure points inwards";
}

TEST(LammpsDeck, WritesEachAtomOnceWithItsVelocity) {
  const LammpsTask task = loose_task(small());
  const std::size_t atoms = 100 + task.cell.wall_grains.size();  // the deck makes the moving wall
  const WallPose pose = wall_pose(task.cell, 0, task.state.wall_height);
  std::istringstream data(
      lammps_data(particles_of(task.cell, pose, task.state, 0, task.units), "title"));
  std::size_t lines = 0, sections = 0;
  std::vector<std::size_t> seen(atoms + 1, 0);
  for (std::string line; std::getline(data, line);) {
    if (line.rfind("Atoms", 0) == 0 || line == "Velocities") ++sections;
    if (sections == 0 || line.empty() || !std::isdigit(static_cast<unsigned char>(line[0]))) {
      continue;
    }
    ++lines;
    const std::size_t id = std::stoul(line);
    ASSERT_LE(id, atoms);
    ++seen[id];
  }
  EXPECT_EQ(lines, 2 * atoms);
  EXPECT_EQ(std::count(seen.begin() + 1, seen.end(), 2U), static_cast<long>(atoms));
}

class LammpsFrame : public testing::Test {
 protected:
  State read(const std::string& text) {
    const auto file = folder_.path() / "frame.7";
    std::ofstream(file, std::ios::binary) << text;
    return read_lammps_frame(file, 2);
  }

  static std::string frame(const std::string& rows, int atoms = 3) {
    return "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n" + std::to_string(atoms) +
           "\nITEM: BOX BOUNDS ss ss pp\n0 1\n0 1\n0 1\nITEM: ATOMS id xu yu zu v_a v_b v_c\n" +
           rows;
  }

  TemporaryFolder folder_;
};

TEST_F(LammpsFrame, CanBeReadInAnyOrder) {
  const State state = read(frame("3 0 2.5 0 0 -1 0\n2 4 5 -6e-1 7 8 9\n1 1 2 3 4 5 6\n"));
  EXPECT_EQ(state.step, 7U);
  EXPECT_EQ(state.wall_height, 2.5);
  EXPECT_EQ(state.wall_velocity, -1);
  EXPECT_EQ(state.position.col(1), Eigen::Vector3d(4, 5, -0.6));
  EXPECT_EQ(state.velocity.col(0), Eigen::Vector3d(4, 5, 6));
}

TEST_F(LammpsFrame, IsRejectedIfIncomplete) {
  const std::string good = "1 1 2 3 4 5 6\n2 4 5 6 7 8 9\n3 0 2.5 0 0 -1 0\n";
  for (const std::string& text :
       {std::string(), frame(good.substr(0, 20)), frame(good, 4), frame("ITEM: ATOMS\n"),
        frame("1 1 2 3 4 5 6\n1 4 5 6 7 8 9\n3 0 2.5 0 0 -1 0\n"),
        frame("0 1 2 3 4 5 6\n2 4 5 6 7 8 9\n3 0 2.5 0 0 -1 0\n"),
        frame("1 1 2 x 4 5 6\n2 4 5 6 7 8 9\n3 0 2.5 0 0 -1 0\n"),
        frame("1 1 2 1e999 4 5 6\n2 4 5 6 7 8 9\n3 0 2.5 0 0 -1 0\n")}) {
    SCOPED_TRACE(text);
    expect_refused<std::runtime_error>([&] { read(text); }, {"frame.7"});
  }
}

}  // namespace
}  // namespace shearcell::test
