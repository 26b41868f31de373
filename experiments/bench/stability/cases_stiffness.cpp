// SPDX-License-Identifier: GPL-3.0-or-later
// Springs up to ten thousand times as stiff as those of Table I.
#include <fmt/format.h>

#include <cmath>

#include "core/minimizer.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

// With time measured s times finer everything runs s times as fast along the same way.
Scene faster(Scene scene, double s) {
  scene.stiffness *= s * s;
  scene.gravity *= s * s;
  scene.pressure *= s * s;
  scene.drag_rate *= s;
  scene.wall_drag *= s;
  scene.time_step /= s;
  return scene;
}

Outcome similar(double ratio) {
  const Packing& packing = settled_packing();
  const Drive drive{0.0833, 2000, 0};
  const auto after = [&](double s, std::uint64_t steps) {
    State start = packing.state;
    start.velocity *= s;
    start.wall_velocity *= s;
    Simulation simulation(packing.cell, faster(packing.scene, s), start);
    simulation.advance(drive, steps);
    return simulation.state();
  };
  // Powers of four scale every number by a power of two, which rounds nothing.
  const double power = std::exp2(std::round(std::log2(ratio) / 2));
  const State right = after(1, 2000);
  const double exact = largest_difference(after(power, 2000), right);
  const double near = largest_difference(after(std::sqrt(ratio), 300), after(1, 300));
  return all_of(
      {expect_at_most(fmt::format("after a cycle at {:g} k0, moved otherwise by", power * power),
                      exact, 0),
       expect_at_most(fmt::format("after 300 steps at {:g} k0", ratio), near, 1e-9)});
}

// Grains side by side between two walls carry P A and their weight.
Outcome balance(double ratio, bool quick) {
  Scene scene = table_1();
  scene.stiffness *= ratio;
  scene.time_step /= std::sqrt(ratio);
  Packing row = row_between_walls(3, scene);
  Simulation simulation(row.cell, scene, row.state);
  const double seconds = quick ? 0.6 : 1.5;
  simulation.advance(Drive{}, static_cast<std::uint64_t>(seconds / scene.time_step));
  const State end = simulation.state();
  const double load = scene.pressure * row.cell.width * row.cell.depth / 3;
  const double below = load / scene.stiffness, above = (load - scene.gravity) / scene.stiffness;
  const double tolerance = quick ? 1e-6 : 1e-8;
  return all_of(
      {expect_near("overlap below / (P A / 3 k)",
                   (0.5 - (end.position(1, 1) - end.wall_height)) / below, 1, tolerance),
       expect_near("above", (0.5 - (row.cell.top - end.position(1, 1))) / above, 1, tolerance)});
}

// The time step of Table I is 0.355 of 2/sqrt(8 k/m), so 7.95 k0 is the most that it allows.
Outcome fixed_step(double ratio) {
  const Packing& packing = settled_packing();
  Scene scene = packing.scene;
  scene.stiffness *= ratio;
  Simulation simulation(packing.cell, scene, packing.state);
  if (ratio > 8) return expect_stop(simulation, Drive{}, 20000, "time step");
  simulation.advance(Drive{}, 60000);
  return all_of(
      {expect_at_most("largest net force / P d^2",
                      force_residual(packing.cell, scene, simulation.state()), 1e-6),
       expect_at_most("kinetic energy per grain", kinetic_energy(simulation.state()), 1e-12)});
}

}  // namespace

Cases stiffness_cases() {
  Cases cases;
  for (const double ratio : {1.0, 10.0, 100.0, 1e3, 1e4}) {
    cases.push_back({fmt::format("k-{:g}-similar", ratio),
                     fmt::format("{:g} k0, dt and all loads scaled alike", ratio),
                     "the same way, scaled: to the last bit for a power of four",
                     [ratio](bool) { return similar(ratio); }});
  }
  for (const double ratio : {1.0, 10.0, 100.0, 1e3, 1e4}) {
    cases.push_back({fmt::format("k-{:g}-scaled-dt", ratio),
                     fmt::format("{:g} k0 with dt ~ 1/sqrt(k) under the loads of Table I", ratio),
                     "overlaps P A / 3 k below and that less m g / k above",
                     [ratio](bool quick) { return balance(ratio, quick); }});
  }
  for (const double ratio : {1.0, 4.0, 10.0, 100.0, 1e3, 1e4}) {
    cases.push_back({fmt::format("k-{:g}-fixed-dt", ratio),
                     fmt::format("{:g} k0 at the time step of Table I", ratio),
                     ratio > 8 ? "stopped: the time step over its limit"
                               : "comes to rest with all forces in balance",
                     [ratio](bool) { return fixed_step(ratio); }});
  }
  return cases;
}

}  // namespace shearcell::stability
