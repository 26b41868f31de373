// SPDX-License-Identifier: GPL-3.0-or-later
// The time step at which the engine becomes unstable, found by bisection, against 2/omega_max; and
// time steps from a tenth of the stability limit to beyond it with the watchdog on.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "core/random.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

// Small velocities, equal along the axes that are 1, zero along those that are 0.
void stir(State& state, const V& axes) {
  for (Eigen::Index i = 0; i < state.velocity.size(); ++i) {
    const auto u = uniform_pair({static_cast<std::uint32_t>(i), 0, 0, 0}, 5);
    state.velocity.data()[i] = 2e-4 * (u[0] - 0.5) * axes(i % 3);
  }
}

bool grows(Packing packing, double time_step, std::uint64_t steps) {
  packing.scene.time_step = time_step;
  EngineSettings settings;
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
Outcome compare(const Packing& packing, double square, std::uint64_t steps,
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
Outcome pair(double drag_rate) {
  constexpr double overlap = 1e-3;
  Packing packing = placed(only_springs(), {{0.5 - overlap, 2, 2}, {1.5 - 2 * overlap, 2, 2}},
                           {2 - 3 * overlap, 4, 4});
  packing.scene.drag_rate = drag_rate;
  stir(packing.state, {1, 0, 0});
  return compare(packing, 3, drag_rate > 0 ? 100000 : 1000);
}

// Four grains in a ring through the seam: omega^2 = 4 k/m, neighbours against each other.
Outcome ring() {
  constexpr double spacing = 1 - 1e-3;
  Packing packing =
      placed(only_springs(), {{2, 2, 0}, {2, 2, spacing}, {2, 2, 2 * spacing}, {2, 2, 3 * spacing}},
             {4, 4, 4 * spacing});
  stir(packing.state, {0, 0, 1});
  return compare(packing, 4, 1000);
}

Outcome fcc() {
  Packing packing = crystal(9, 1e-3);
  packing.scene.wall_mass = 1e30;
  const double omega = fastest_vibration(packing.cell, packing.scene, packing.state);
  stir(packing.state, {1, 1, 1});
  return compare(packing, omega * omega / packing.scene.stiffness, 1000,
                 " (8 in an infinite crystal)");
}

constexpr std::uint64_t kSteps = 20000;

// At `factor` of the limit; drag damps a small disturbance.
Outcome rests_or_stops(Packing packing, double factor, bool stable) {
  packing.scene.time_step = factor * crystal_limit(packing.scene);
  if (!stable) return expect_stop(packing, kSteps, "time step");
  const State end = advanced(packing, kSteps);
  return all_of({expect_at_most("kinetic energy per grain", kinetic_energy(end), 1e-9),
                 expect_at_most("moved by", largest_difference(end, packing.state), 1e-6)});
}

Packing crystal_in_fluid() {
  Packing packing = in_fluid(crystal(7, 1e-3));
  packing.state.velocity.row(0).setConstant(1e-3);
  return packing;
}

// Loose grains do not feel the limit; the watchdog must see it when they touch.
Outcome stops_while_filling(double factor) {
  Parameters parameters;
  parameters.grains = 60;
  Packing packing = bench::loose_packing(parameters, 1);
  packing.scene.time_step = factor * crystal_limit(packing.scene);
  return expect_stop(packing, 2 * kSteps, "");
}

}  // namespace

Cases time_step_cases() {
  const std::string expected = "unstable from 2/omega_max on, within 5 %";
  Cases cases = {
      {"limit-pair", "two grains between two walls, dt bisected", expected,
       [](bool) { return pair(0); }},
      {"limit-pair-drag", "the same with the drag of Table I and with 1e4 times that", expected,
       [](bool) {
         return all_of({pair(64), pair(64e4)});
       }},
      {"limit-chain", "a ring of four grains through the seam, dt bisected", expected,
       [](bool) { return ring(); }},
      {"limit-fcc", "a small FCC crystal between smooth walls, dt bisected", expected,
       [](bool) { return fcc(); }},
  };
  // A disordered packing vibrates more slowly than a crystal: its limit is above 1.
  const struct {
    std::string what;
    std::vector<double> stable, unstable;
    Packing (*make)();
  } rows[] = {{"crystal", {0.1, 0.3, 0.5, 0.7, 0.9, 0.98}, {1.02, 1.1, 1.2}, crystal_in_fluid},
              {"packing", {0.1, 0.5, 0.9}, {1.1, 1.2}, [] { return settled(); }}};
  for (const auto& row : rows) {
    for (const bool stable : {true, false}) {
      for (const double factor : stable ? row.stable : row.unstable) {
        cases.push_back({fmt::format("dt-{}-{:.2f}", row.what, factor),
                         fmt::format("{} at dt = {:.2f} of 2/sqrt(8 k/m)", row.what, factor),
                         stable ? "stays at rest" : "stopped: the time step over its limit",
                         [make = row.make, factor, stable](bool) {
                           return rests_or_stops(make(), factor, stable);
                         }});
      }
    }
  }
  for (const double factor : {1.1, 1.2}) {
    cases.push_back({fmt::format("dt-loose-{:.2f}", factor),
                     fmt::format("loose grains pressed together at dt = {:.2f}", factor),
                     "stopped before they are dense",
                     [factor](bool) { return stops_while_filling(factor); }});
  }
  return cases;
}

}  // namespace shearcell::stability
