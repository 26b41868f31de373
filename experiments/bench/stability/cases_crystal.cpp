// SPDX-License-Identifier: GPL-3.0-or-later
// Crystals with a grain too few, grains that nobody holds, and speeds below the normal numbers.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "core/diagnostics.hpp"
#include "core/minimizer.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

std::vector<int> contacts_of_grains(const Packing& packing, const State& state) {
  std::vector<int> contacts(static_cast<std::size_t>(state.position.cols()));
  for_each_contact(packing.cell, state.position, wall_pose(packing.cell, 0, state.wall_height),
                   [&](const Contact& c) {
                     ++contacts[static_cast<std::size_t>(c.grain)];
                     if (c.kind != Contact::Kind::grain) return;
                     ++contacts[static_cast<std::size_t>(c.other)];
                   });
  return contacts;
}

int sum(const std::vector<int>& contacts) {
  int total = 0;
  for (const int n : contacts) total += n;
  return total;
}

// The twelve neighbours of the grain that is missing have a contact less each, and hold.
Outcome vacancy() {
  const Packing whole = crystal(7, 1e-3), missing = crystal(7, 1e-3, 5, true);
  Scene scene = missing.scene;
  scene.drag_rate = table_1().drag_rate;
  scene.wall_drag = table_1().wall_drag;
  State start = missing.state;
  for (Eigen::Index i = 0; i < start.velocity.size(); ++i) {
    start.velocity.data()[i] = std::sin(3.0 * static_cast<double>(i * i));
  }
  start.velocity.row(2).array() -= start.velocity.row(2).mean();  // nothing holds it along z
  Simulation simulation(missing.cell, scene, start);
  simulation.advance(Drive{}, 100000);
  const State end = simulation.state();
  const int lost =
      sum(contacts_of_grains(whole, whole.state)) - sum(contacts_of_grains(missing, end));
  return all_of(
      {expect_near("contacts lost, from both sides", lost, 24, 0),
       expect_at_most("largest net force / P d^2", force_residual(missing.cell, scene, end), 1e-6),
       expect_at_most("moved by", largest_difference(end, missing.state), 1e-6)});
}

// Grains that the others leave loose change nothing for these.
Outcome rattlers() {
  Packing packing = settled_packing();
  packing.scene.gravity = 0;
  Simulation relax(packing.cell, packing.scene, packing.state);
  relax.advance(Drive{}, 100000);
  State with = relax.state();
  with.step = 0;
  const std::vector<int> contacts = contacts_of_grains(packing, with);
  State without = with;
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < with.position.cols(); ++i) {
    if (contacts[static_cast<std::size_t>(i)] == 0) continue;
    without.position.col(kept) = with.position.col(i);
    without.velocity.col(kept++) = with.velocity.col(i);
  }
  const Eigen::Index loose = with.position.cols() - kept;
  without.position.conservativeResize(3, kept);
  without.velocity.conservativeResize(3, kept);
  const Drive drive{1e-6, 20000, 0};
  Simulation all(packing.cell, packing.scene, with), held(packing.cell, packing.scene, without);
  all.advance(drive, 20000);
  held.advance(drive, 20000);
  const State end = all.state();
  State of_held = held.state();
  double difference = std::fabs(end.wall_height - of_held.wall_height);
  for (Eigen::Index i = 0, k = 0; i < with.position.cols(); ++i) {
    if (contacts[static_cast<std::size_t>(i)] == 0) continue;
    difference = std::max(difference, (end.position.col(i) - of_held.position.col(k++)).norm());
  }
  return all_of({{loose > 0, fmt::format("{} of {} grains are loose", loose, end.position.cols())},
                 expect_at_most("without them the others move otherwise by", difference, 0)});
}

double seconds_of(Simulation& simulation, std::uint64_t steps) {
  double best = 1e300;
  for (int repeat = 0; repeat < 9; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    simulation.advance(Drive{}, steps);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count());
  }
  return best;
}

// Drag alone takes a grain that nothing touches below the normal numbers after ten seconds.
Outcome subnormal(bool quick) {
  const Cell cell = smooth_cell(20, 20, 20);
  Scene scene = only_springs();
  scene.drag_rate = 64;
  std::vector<Eigen::Vector3d> positions;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column)
      positions.emplace_back(1.5 + 1.7 * column, 1.5 + 1.7 * row, 5);
  }
  const auto timed = [&](double speed, std::uint64_t steps_before) {
    State state = at_rest(cell, positions);
    state.velocity.setConstant(speed);
    Simulation simulation(cell, scene, state);
    simulation.advance(Drive{}, steps_before);
    const double seconds = seconds_of(simulation, quick ? 3000 : 10000);
    return std::pair(seconds, simulation.state().velocity.cwiseAbs().maxCoeff());
  };
  const auto usual = timed(1e-3, 2048);
  const auto given = timed(1e-310, 2048);
  const auto decayed = timed(1e-280, 40000);
  const double largest = std::max(given.second, decayed.second);
  return all_of({expect_at_most("time of a step over that at 1e-3 d/s, from 1e-310 d/s",
                                given.first / usual.first, 2),
                 expect_at_most("decayed to there", decayed.first / usual.first, 2),
                 expect_at_most("then the speed is", largest, 0)});
}

}  // namespace

Cases crystal_cases() {
  return {
      {"vacancy", "a crystal with one grain fewer, stirred",
       "comes back to rest; its twelve neighbours lose a contact each",
       [](bool) { return vacancy(); }},
      {"rattlers", "a packing without gravity, sheared with and without its loose grains",
       "the others move alike to the last bit", [](bool) { return rattlers(); }},
      {"subnormal-speed", "grains at 1e-310 d/s, given or decayed to by drag",
       "set to rest; a step costs no more than at other speeds", subnormal},
  };
}

}  // namespace shearcell::stability
