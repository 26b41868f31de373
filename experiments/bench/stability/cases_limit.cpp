// SPDX-License-Identifier: GPL-3.0-or-later
// The time step at which the engine becomes unstable, found by bisection, against 2/omega_max.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "core/random.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

/// Small velocities, equal along the axes that are 1 and none along those that are 0.
void stir(State& state, const Eigen::Vector3d& axes) {
  for (Eigen::Index i = 0; i < state.velocity.size(); ++i) {
    const auto u = uniform_pair({static_cast<std::uint32_t>(i), 0, 0, 0}, 5);
    state.velocity.data()[i] = 2e-4 * (u[0] - 0.5) * axes(i % 3);
  }
}

bool grows(const Packing& packing, double time_step, std::uint64_t steps) {
  Scene scene = packing.scene;
  scene.time_step = time_step;
  Simulation simulation(packing.cell, scene, packing.state, any_time_step());
  if (advance_or_stop(simulation, Drive{}, steps)) return true;
  // Below the limit a mode grows by at most 1/sqrt(1 - (dt/limit)^2).
  return !(simulation.state().velocity.cwiseAbs().maxCoeff() <
           300 * packing.state.velocity.cwiseAbs().maxCoeff());
}

double bisect(const Packing& packing, double analytic, std::uint64_t steps) {
  double stable = 0.5 * analytic, unstable = 1.5 * analytic;
  for (int n = 0; n < 12; ++n) {
    const double middle = 0.5 * (stable + unstable);
    (grows(packing, middle, steps) ? unstable : stable) = middle;
  }
  return 0.5 * (stable + unstable);
}

// `square` is omega_max^2 in units of k/m.
Outcome compare(const Packing& packing, double square, std::uint64_t steps,
                const std::string& more = "") {
  const double analytic = 2 / std::sqrt(square * packing.scene.stiffness);
  const double found = bisect(packing, analytic, steps);
  const double off = found / analytic - 1;
  return {std::fabs(off) < 0.05,
          fmt::format("unstable from dt = {:.5g} s; 2/omega_max = {:.5g} s with omega_max^2 = "
                      "{:.4g} k/m{}; off by {:+.2g} %",
                      found, analytic, square, more, 100 * off)};
}

// Two grains and two walls in a row, all overlaps alike: the fastest mode moves both against each
// other, omega^2 = 3 k/m. Drag does not shift the limit, for it is taken implicitly.
Outcome pair(double drag_rate) {
  constexpr double overlap = 1e-3;
  Packing packing{smooth_cell(2 - 3 * overlap, 4, 4), only_springs(), {}};
  packing.scene.drag_rate = drag_rate;
  packing.state = at_rest(packing.cell, {{0.5 - overlap, 2, 2}, {1.5 - 2 * overlap, 2, 2}});
  stir(packing.state, {1, 0, 0});
  return compare(packing, 3, drag_rate > 0 ? 100000 : 1000);
}

// Four grains in a ring through the seam: omega^2 = 4 k/m, neighbours against each other.
Outcome chain() {
  constexpr double overlap = 1e-3;
  constexpr int length = 4;
  Packing packing{smooth_cell(4, 4, length * (1 - overlap)), only_springs(), {}};
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < length; ++i) positions.emplace_back(2, 2, (1 - overlap) * i);
  packing.state = at_rest(packing.cell, positions);
  stir(packing.state, {0, 0, 1});
  return compare(packing, 4, 1000);
}

Outcome fcc() {
  Packing packing = crystal(9, 1e-3);
  packing.scene.wall_mass = 1e30;
  const double omega = fastest_vibration(packing.cell, packing.scene, packing.state);
  const double square = omega * omega / packing.scene.stiffness;
  stir(packing.state, {1, 1, 1});
  return compare(packing, square, 1000, " (8 without end)");
}

}  // namespace

Cases stability_limit_cases() {
  const std::string expected = "unstable from 2/omega_max on, within 5 %";
  return {
      {"limit-pair", "two grains between two walls, dt bisected", expected,
       [](bool) { return pair(0); }},
      {"limit-pair-drag", "the same with the drag of Table I, and with 1e4 times it", expected,
       [](bool) {
         return all_of({pair(64), pair(64e4)});
       }},
      {"limit-chain", "a ring of four grains through the seam, dt bisected", expected,
       [](bool) { return chain(); }},
      {"limit-fcc", "a small FCC crystal between smooth walls, dt bisected", expected,
       [](bool) { return fcc(); }},
  };
}

}  // namespace shearcell::stability
