// SPDX-License-Identifier: GPL-3.0-or-later
// Ten million steps.
#include <fmt/format.h>

#include <cmath>

#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

// Driven to and fro, a damped crystal comes to a motion that repeats itself: after every cycle it
// is where it was.
Outcome many_cycles(bool quick) {
  constexpr std::uint64_t kCycle = 200;
  const std::uint64_t cycles = quick ? 2500 : 50000;
  Packing packing = crystal(3, 2e-3, 3);
  packing.scene.drag_rate = table_1().drag_rate;
  packing.scene.wall_drag = table_1().wall_drag;
  const Drive drive{1e-3, kCycle, 0};
  Simulation simulation(packing.cell, packing.scene, packing.state);
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
  return all_of({{in_phase, fmt::format("{} cycles, {}", cycles,
                                        in_phase ? "each upright at its end" : "out of phase")},
                 expect_at_most("height drifts by", heights, 1e-10),
                 expect_at_most("grains by", largest_difference(simulation.state(), early), 1e-10),
                 expect_at_most("momentum along z is", momentum, 1e-9)});
}

// Nothing damps it, so that every error adds up.
Outcome many_vibrations(bool quick) {
  Packing packing = crystal(3, 2e-3, 3);
  packing.scene.wall_mass = 1e30;
  Simulation still(packing.cell, packing.scene, packing.state);
  const double at_minimum = total_energy(still);
  for (Eigen::Index i = 0; i < packing.state.velocity.size(); ++i) {
    packing.state.velocity.data()[i] = 0.3 * std::sin(5.0 * static_cast<double>(i * i));
  }
  packing.state.velocity.row(2).array() -= packing.state.velocity.row(2).mean();
  Simulation simulation(packing.cell, packing.scene, packing.state);
  const double first = mean_energy(simulation, 2000);
  simulation.advance(Drive{}, quick ? 500'000 : 10'000'000);
  const double last = mean_energy(simulation, 2000);
  return all_of({expect_at_most("energy of the vibration changed by",
                                std::fabs(last - first) / (first - at_minimum), 1e-4),
                 expect_at_most("momentum along z is",
                                std::fabs(simulation.state().velocity.row(2).sum()), 1e-9)});
}

}  // namespace

Cases long_cases() {
  return {
      {"1e7-steps-sheared", "a small crystal sheared for 50 000 cycles of 200 steps",
       "no drift in phase, height, place or momentum", many_cycles},
      {"1e7-steps-undamped", "a small crystal vibrates 1e7 steps without drag",
       "no drift in energy or momentum", many_vibrations},
  };
}

}  // namespace shearcell::stability
