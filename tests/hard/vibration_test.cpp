// SPDX-License-Identifier: GPL-3.0-or-later
// The time step at which the engine becomes unstable, found by bisection, against 2/omega_max; time
// steps from a tenth of the stability limit to beyond it with the watchdog on; and small motions of
// crystals and packings, for up to ten million steps.
#include <cmath>
#include <utility>

#include "core/diagnostics.hpp"
#include "provenance/io/clock.hpp"
#include "tests/hard/hard.hpp"

namespace shearcell::test {
namespace {

bool grows(Packing packing, double time_step, std::uint64_t steps) {
  packing.scene.time_step = time_step;
  SimulationSettings settings;
  settings.limits.time_step = 1e9;  // do not stop for the time step
  Simulation simulation = simulate(packing, settings);
  try {
    simulation.advance(Drive{}, steps);
  } catch (const NumericalFailure&) {
    return true;
  }
  // Below the limit a mode grows by at most 1/sqrt(1 - (dt/limit)^2).
  return !(simulation.state().velocity.cwiseAbs().maxCoeff() <
           300 * packing.state.velocity.cwiseAbs().maxCoeff());
}

// Bisects the stability limit; `square` is omega_max^2 in units of k/m.
Answer compare(const Packing& packing, double square, std::uint64_t steps,
               const std::string& more = "") {
  const double analytic = 2 / std::sqrt(square * packing.scene.stiffness);
  double stable = 0.5 * analytic, unstable = 1.5 * analytic;
  for (int n = 0; n < 12; ++n) {
    const double middle = 0.5 * (stable + unstable);
    (grows(packing, middle, steps) ? unstable : stable) = middle;
  }
  const double found = 0.5 * (stable + unstable), off = found / analytic - 1;
  return {std::fabs(off) < 0.05,
          fmt::format("unstable from dt = {:.5g} s; 2/omega_max = {:.5g} s with omega_max^2 = "
                      "{:.4g} k/m{}; off by {:+.2g} %",
                      found, analytic, square, more, 100 * off)};
}

// Two grains and two walls in a row, equal overlaps: in the fastest mode the grains move against
// each other, omega^2 = 3 k/m. Drag does not shift the limit, because it is implicit.
Answer pair(double drag_rate) {
  constexpr double overlap = 1e-3;
  Packing packing = placed(only_springs(), {{0.5 - overlap, 2, 2}, {1.5 - 2 * overlap, 2, 2}},
                           {2 - 3 * overlap, 4, 4});
  packing.scene.drag_rate = drag_rate;
  disturb(packing.state, {1e-4, 0, 0});
  return compare(packing, 3, drag_rate > 0 ? 100000 : 1000);
}

// Four grains in a ring through the seam: omega^2 = 4 k/m, neighbours against each other.
Answer chain() {
  constexpr double spacing = 1 - 1e-3;
  Packing packing =
      placed(only_springs(), {{2, 2, 0}, {2, 2, spacing}, {2, 2, 2 * spacing}, {2, 2, 3 * spacing}},
             {4, 4, 4 * spacing});
  disturb(packing.state, {0, 0, 1e-4});
  return compare(packing, 4, 1000);
}

// Largest angular frequency [rad/s] of small vibrations about a state between upright walls at
// rest, including the load on each contact. Power iteration: too low by a relative 1e-4 at most.
double fastest_vibration(const Cell& cell, const Scene& scene, const State& state) {
  std::vector<Contact> contacts;
  for_each_contact(cell, state.position, wall_pose(cell, 0, state.wall_height),
                   [&](const Contact& contact) { contacts.push_back(contact); });
  Eigen::Matrix3Xd mode(3, state.position.cols());
  for (Eigen::Index i = 0; i < mode.size(); ++i) {
    mode.data()[i] = std::sin(1.0 + 12.9898 * static_cast<double>(i * i));  // no symmetry
  }
  double square = 0;
  for (int iteration = 0; iteration < 3000; ++iteration) {
    mode /= mode.norm();
    Eigen::Matrix3Xd pull = Eigen::Matrix3Xd::Zero(3, mode.cols());
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

Answer fcc() {
  Packing packing = crystal(9, 1e-3);
  packing.scene.wall_mass = 1e30;
  const double omega = fastest_vibration(packing.cell, packing.scene, packing.state);
  disturb(packing.state, V::Constant(1e-4));
  return compare(packing, omega * omega / packing.scene.stiffness, 1000,
                 " (8 in an infinite crystal)");
}

constexpr std::uint64_t kSteps = 20000;

Packing crystal_in_fluid() {
  Packing packing = in_fluid(crystal(7, 1e-3));
  packing.state.velocity.row(0).setConstant(1e-3);
  return packing;
}

// Loose grains do not feel the limit; the watchdog must see it when they touch.
Packing loose() {
  Parameters parameters;
  parameters.grains = 60;
  return loose_packing(parameters, 1);
}

template <Packing (*make)()>
Packing at_part_of_limit(double factor) {
  Packing packing = make();
  packing.scene.time_step = factor * 2 / std::sqrt(8 * packing.scene.stiffness);
  return packing;
}

// Drag damps a small disturbance.
template <Packing (*make)()>
Answer rests(double factor) {
  const Packing packing = at_part_of_limit<make>(factor);
  const State end = advanced(packing, kSteps);
  return all_of({expect_at_most("kinetic energy per grain", kinetic_energy(end), 1e-9),
                 expect_at_most("moved by", largest_difference(end, packing.state), 1e-6)});
}

template <Packing (*make)()>
Answer stops(double factor) {
  return expect_stop(at_part_of_limit<make>(factor), kSteps, "time step");
}

Answer stops_while_filling(double factor) {
  return expect_stop(at_part_of_limit<loose>(factor), 2 * kSteps, "");
}

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
Answer vacancy() {
  const Packing whole = crystal(7, 1e-3);
  Packing missing = in_fluid(crystal(7, 1e-3, 5, true));
  disturb(missing.state, V::Ones());
  const State end = advanced(missing, 100000);
  int lost = 0;
  for (const int n : contacts_of_grains(whole, whole.state)) lost += n;
  for (const int n : contacts_of_grains(missing, end)) lost -= n;
  return all_of({expect_near("contacts lost, from both sides", lost, 24, 0),
                 expect_balance(missing, end, 1e-6),
                 expect_at_most("moved by", largest_difference(end, missing.state), 1e-6)});
}

// Grains without contacts do not influence the others.
Answer rattlers() {
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

// After ten seconds of drag the speed of a free grain is a subnormal number. The time of a step is
// reported but not judged, because other programs share the machine.
Answer subnormal() {
  Scene scene = only_springs();
  scene.drag_rate = 64;
  std::vector<V> positions;
  for (int n = 0; n < 100; ++n) {
    positions.emplace_back(1.5 + 1.7 * (n % 10), 1.5 + 1.7 * (n / 10), 5);
  }
  // Best time of nine, and the largest speed at the end.
  const auto timed = [&](double speed, std::uint64_t steps_before) {
    Packing packing = placed(scene, positions, {20, 20, 20});
    packing.state.velocity.setConstant(speed);
    Simulation simulation = simulate(packing);
    simulation.advance(Drive{}, steps_before);
    double best = 1e300;
    for (int repeat = 0; repeat < 9; ++repeat) {
      const Stopwatch watch;
      simulation.advance(Drive{}, in_full() ? 10000 : 3000);
      best = std::min(best, watch.seconds());
    }
    return std::pair(best, simulation.state().velocity.cwiseAbs().maxCoeff());
  };
  const auto usual = timed(1e-3, 2048), given = timed(1e-310, 2048), decayed = timed(1e-280, 40000);
  fmt::print("time of a step over that at 1e-3 d/s: {:.2f} from 1e-310 d/s, {:.2f} after decay\n",
             given.first / usual.first, decayed.first / usual.first);
  return expect_at_most("largest speed", std::max(given.second, decayed.second), 0);
}

// A driven, damped crystal repeats its motion: after every cycle it is where it was.
Answer many_cycles() {
  constexpr std::uint64_t kCycle = 200;
  const std::uint64_t cycles = in_full() ? 50000 : 2500;
  const Drive drive{1e-3, kCycle, 0};
  Simulation simulation = simulate(in_fluid(crystal(3, 2e-3, 3)));
  simulation.advance(drive, cycles / 5 * kCycle);
  const State early = simulation.state();
  double heights = 0, momentum = 0;
  while (simulation.step() < cycles * kCycle) {
    simulation.advance(drive, kCycle);
    const State now = simulation.state();
    heights = std::max(heights, std::fabs(now.wall_height - early.wall_height));
    momentum = std::max(momentum, std::fabs(now.velocity.row(2).sum()));
  }
  const std::uint64_t step = simulation.step();
  const bool in_phase =
      tilt(drive, step).theta == 0 && tilt(drive, step + kCycle / 4).theta == drive.amplitude;
  return all_of(
      {{in_phase,
        fmt::format("{} cycles, {}", cycles, in_phase ? "upright at the end" : "out of phase")},
       expect_at_most("drift of the height", heights, 1e-10),
       expect_at_most("of the grains", largest_difference(simulation.state(), early), 1e-10),
       expect_at_most("momentum along z", momentum, 1e-9)});
}

// Energy of contacts and motion between upright walls [m d^2/s^2], averaged over `samples` 7 steps
// apart, because the leapfrog keeps a slightly different energy. The kinetic energy is the mean of
// those half a step before and after.
double mean_energy(Simulation& simulation, int samples) {
  double sum = 0;
  for (int n = 0; n < samples; ++n) {
    const State before = simulation.state();
    for_each_contact(simulation.cell(), before.position,
                     wall_pose(simulation.cell(), 0, before.wall_height), [&](const Contact& c) {
                       sum += 0.5 * simulation.scene().stiffness * c.overlap * c.overlap;
                     });
    simulation.advance(Drive{}, 1);
    sum += 0.25 * (before.velocity.squaredNorm() + simulation.state().velocity.squaredNorm());
    simulation.advance(Drive{}, 6);
  }
  return sum / samples;
}

// Energy and momentum of a crystal that vibrates at about `speed` [d/s] without drag, all contacts
// closed.
Answer vibrations(Packing packing, double speed, int samples, std::uint64_t steps, double most) {
  packing.scene.wall_mass = 1e30;
  Simulation still = simulate(packing);
  const double at_minimum = mean_energy(still, 1);
  disturb(packing.state, V::Constant(speed));
  Simulation simulation = simulate(packing);
  const double first = mean_energy(simulation, samples);
  simulation.advance(Drive{}, steps);
  const double last = mean_energy(simulation, samples);
  return all_of({expect_at_most("relative change of the vibration's energy",
                                std::fabs(last - first) / (first - at_minimum), most),
                 expect_at_most("momentum along z",
                                std::fabs(simulation.state().velocity.row(2).sum()), 1e-9)});
}

Cases vibration_cases() {
  Cases cases;
  const std::string expected = "unstable from 2/omega_max on, within 5 %";
  add(cases, "limit-pair", "two grains between two walls, dt bisected", expected,
      [] { return pair(0); });
  add(cases, "limit-pair-drag",
      "two grains between two walls with the drag of Table I and with 1e4 times that, dt bisected",
      expected, [] {
        return all_of({pair(64), pair(64e4)});
      });
  add(cases, "limit-chain", "a ring of four grains through the seam, dt bisected", expected, chain);
  add(cases, "limit-fcc", "a small FCC crystal between smooth walls, dt bisected", expected, fcc);

  const std::string at = " at dt = {:.2f} of 2/sqrt(8 k/m)", rest = "stays at rest";
  const std::string stop = "stopped: the time step over its limit";
  add_each(cases, {0.1, 0.3, 0.5, 0.7, 0.9, 0.98}, "dt-crystal-{:.2f}", "crystal" + at, rest,
           rests<crystal_in_fluid>);
  add_each(cases, {1.02, 1.1, 1.2}, "dt-crystal-{:.2f}", "crystal" + at, stop,
           stops<crystal_in_fluid>);
  // A disordered packing vibrates more slowly than a crystal: its limit is above 1.
  add_each(cases, {0.1, 0.5, 0.9}, "dt-packing-{:.2f}", "packing" + at, rest, rests<settled>);
  add_each(cases, {1.1, 1.2}, "dt-packing-{:.2f}", "packing" + at, stop, stops<settled>);
  add_each(cases, {1.1, 1.2}, "dt-loose-{:.2f}", "loose grains pressed together at dt = {:.2f}",
           "stopped before they are dense", stops_while_filling);

  add(cases, "vacancy", "a crystal without one grain, disturbed",
      "returns to rest; the twelve neighbours lose a contact each", vacancy);
  add(cases, "rattlers", "a packing without gravity, sheared with and without its loose grains",
      "the others move alike to the last bit", rattlers);
  add(cases, "subnormal-speed", "grains at 1e-310 d/s, at the start or after decay by drag",
      "set to rest", subnormal);
  add(cases, "drag-0", "a crystal vibrates 1e6 steps without drag", "energy and momentum are kept",
      [] { return vibrations(crystal(5, 2e-3), 1, 1000, in_full() ? 1'000'000 : 20'000, 1e-3); });
  add(cases, "1e7-steps-sheared", "a small crystal sheared for 50 000 cycles of 200 steps",
      "no drift in phase, height, position or momentum", many_cycles);
  add(cases, "1e7-steps-undamped", "a small crystal vibrates 1e7 steps without drag",
      "no drift in energy or momentum", [] {
        return vibrations(crystal(3, 2e-3, 3), 0.3, 2000, in_full() ? 10'000'000 : 500'000, 1e-4);
      });
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Vibration, Hard, testing::ValuesIn(vibration_cases()), test_name);

}  // namespace
}  // namespace shearcell::test
