// SPDX-License-Identifier: GPL-3.0-or-later
// Crystals with a vacancy, grains without contacts, speeds below the normal numbers, and up to ten
// million steps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/diagnostics.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"
#include "provenance/io/clock.hpp"

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

// The twelve neighbours of the vacancy have one contact less each, and stay in place.
Outcome vacancy() {
  const Packing whole = crystal(7, 1e-3);
  Packing missing = in_fluid(crystal(7, 1e-3, 5, true));
  Eigen::Matrix3Xd& v = missing.state.velocity;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    v.data()[i] = std::sin(3.0 * static_cast<double>(i * i));
  }
  v.row(2).array() -= v.row(2).mean();  // nothing holds the crystal along z
  const State end = advanced(missing, 100000);
  int lost = 0;
  for (const int n : contacts_of_grains(whole, whole.state)) lost += n;
  for (const int n : contacts_of_grains(missing, end)) lost -= n;
  return all_of({expect_near("contacts lost, from both sides", lost, 24, 0),
                 expect_balance(missing, end, 1e-6),
                 expect_at_most("moved by", largest_difference(end, missing.state), 1e-6)});
}

// Grains without contacts do not influence the others.
Outcome rattlers() {
  Packing with = settled();
  with.scene.gravity = 0;
  with.state = advanced(with, 100000);
  with.state.step = 0;
  const std::vector<int> contacts = contacts_of_grains(with, with.state);
  std::vector<Eigen::Index> held;
  for (Eigen::Index i = 0; i < with.state.position.cols(); ++i) {
    if (contacts[static_cast<std::size_t>(i)] > 0) held.push_back(i);
  }
  Packing without = with;
  without.state.position = with.state.position(Eigen::all, held).eval();
  without.state.velocity = with.state.velocity(Eigen::all, held).eval();
  const Drive drive{1e-6, 20000, 0};
  State end = advanced(with, 20000, drive);
  const auto loose = static_cast<std::size_t>(end.position.cols()) - held.size();
  end.position = end.position(Eigen::all, held).eval();
  return all_of({{loose > 0, fmt::format("{} of {} grains are loose", loose, contacts.size())},
                 expect_at_most("difference of the others without them",
                                largest_difference(end, advanced(without, 20000, drive)), 0)});
}

// Drag alone takes the speed of a free grain below the normal numbers after ten seconds.
Outcome subnormal(bool quick) {
  Scene scene = only_springs();
  scene.drag_rate = 64;
  std::vector<V> positions;
  for (int n = 0; n < 100; ++n)
    positions.emplace_back(1.5 + 1.7 * (n % 10), 1.5 + 1.7 * (n / 10), 5);
  // Best time of nine, and the largest speed at the end.
  const auto timed = [&](double speed, std::uint64_t steps_before) {
    Packing packing = placed(scene, positions, {20, 20, 20});
    packing.state.velocity.setConstant(speed);
    Simulation simulation = simulate(packing);
    simulation.advance(Drive{}, steps_before);
    double best = 1e300;
    for (int repeat = 0; repeat < 9; ++repeat) {
      const Stopwatch watch;
      simulation.advance(Drive{}, quick ? 3000 : 10000);
      best = std::min(best, watch.seconds());
    }
    return std::pair(best, simulation.state().velocity.cwiseAbs().maxCoeff());
  };
  const auto usual = timed(1e-3, 2048), given = timed(1e-310, 2048), decayed = timed(1e-280, 40000);
  return all_of({expect_at_most("time of a step over that at 1e-3 d/s, from 1e-310 d/s",
                                given.first / usual.first, 2),
                 expect_at_most("decayed to that", decayed.first / usual.first, 2),
                 expect_at_most("then the speed is", std::max(given.second, decayed.second), 0)});
}

// A driven, damped crystal repeats its motion: after every cycle it is where it was.
Outcome many_cycles(bool quick) {
  constexpr std::uint64_t kCycle = 200;
  const std::uint64_t cycles = quick ? 2500 : 50000;
  const Drive drive{1e-3, kCycle, 0};
  Simulation simulation = simulate(in_fluid(crystal(3, 2e-3, 3)));
  simulation.advance(drive, cycles / 5 * kCycle);
  const State early = simulation.state();
  bool in_phase = true;
  double heights = 0, momentum = 0;
  while (simulation.step() < cycles * kCycle) {
    simulation.advance(drive, kCycle);
    const std::uint64_t step = simulation.step();
    in_phase = in_phase && tilt(drive, step).theta == 0 &&
               tilt(drive, step + kCycle / 4).theta == drive.amplitude;
    const State now = simulation.state();
    heights = std::max(heights, std::fabs(now.wall_height - early.wall_height));
    momentum = std::max(momentum, std::fabs(now.velocity.row(2).sum()));
  }
  return all_of(
      {{in_phase, fmt::format("{} cycles, {}", cycles,
                              in_phase ? "each upright at its end" : "out of phase")},
       expect_at_most("drift of the height", heights, 1e-10),
       expect_at_most("of the grains", largest_difference(simulation.state(), early), 1e-10),
       expect_at_most("momentum along z", momentum, 1e-9)});
}

// Energy and momentum of a crystal that vibrates at about `speed` [d/s] without drag, all contacts
// closed.
Outcome vibrations(Packing packing, double speed, int samples, std::uint64_t steps, double most) {
  packing.scene.wall_mass = 1e30;
  Simulation still = simulate(packing);
  const double at_minimum = mean_energy(still, 1);
  Eigen::Matrix3Xd& v = packing.state.velocity;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    v.data()[i] = speed * std::sin(7.0 * static_cast<double>(i * i));
  }
  v.row(2).array() -= v.row(2).mean();
  Simulation simulation = simulate(packing);
  const double first = mean_energy(simulation, samples);
  simulation.advance(Drive{}, steps);
  const double last = mean_energy(simulation, samples);
  return all_of({expect_at_most("relative change of the vibration's energy",
                                std::fabs(last - first) / (first - at_minimum), most),
                 expect_at_most("momentum along z",
                                std::fabs(simulation.state().velocity.row(2).sum()), 1e-9)});
}

}  // namespace

Cases crystal_cases() {
  return {
      {"vacancy", "a crystal without one grain, disturbed",
       "returns to rest; the twelve neighbours lose a contact each",
       [](bool) { return vacancy(); }},
      {"rattlers", "a packing without gravity, sheared with and without its loose grains",
       "the others move alike to the last bit", [](bool) { return rattlers(); }},
      {"subnormal-speed", "grains at 1e-310 d/s, at the start or after decay by drag",
       "set to rest; a step costs no more than at other speeds", subnormal},
      {"drag-0", "a crystal vibrates 1e6 steps without drag", "energy and momentum are kept",
       [](bool quick) {
         return vibrations(crystal(5, 2e-3), 1, 1000, quick ? 20'000 : 1'000'000, 1e-3);
       }},
      {"1e7-steps-sheared", "a small crystal sheared for 50 000 cycles of 200 steps",
       "no drift in phase, height, position or momentum", many_cycles},
      {"1e7-steps-undamped", "a small crystal vibrates 1e7 steps without drag",
       "no drift in energy or momentum",
       [](bool quick) {
         return vibrations(crystal(3, 2e-3, 3), 0.3, 2000, quick ? 500'000 : 10'000'000, 1e-4);
       }},
  };
}

}  // namespace shearcell::stability
