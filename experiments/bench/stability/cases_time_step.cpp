// SPDX-License-Identifier: GPL-3.0-or-later
// Time steps from a tenth of the stability limit to beyond it, with the watchdog on.
#include <fmt/format.h>

#include "core/filling.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

constexpr std::uint64_t kSteps = 20000;

// Drag damps what the stir has stirred; the rest does not depend on the time step.
Outcome comes_to_rest(const Packing& packing, double time_step) {
  Scene scene = packing.scene;
  scene.time_step = time_step;
  Simulation simulation(packing.cell, scene, packing.state);
  if (const auto failure = advance_or_stop(simulation, Drive{}, kSteps)) {
    return {false, words(*failure)};
  }
  const State end = simulation.state();
  return all_of({expect_at_most("kinetic energy per grain", kinetic_energy(end), 1e-9),
                 expect_at_most("moved by", largest_difference(end, packing.state), 1e-6)});
}

Outcome is_stopped(const Packing& packing, double time_step) {
  Scene scene = packing.scene;
  scene.time_step = time_step;
  Simulation simulation(packing.cell, scene, packing.state);
  return expect_stop(simulation, Drive{}, kSteps, "time step");
}

// Loose grains do not feel the limit; it must be seen when they have come together.
Outcome stops_while_filling(double factor) {
  Parameters parameters;
  parameters.grains = 60;
  const Cell cell = make_cell(geometry(parameters), 1);
  Scene scene = settle_scene(parameters);
  scene.time_step = factor * crystal_limit(scene);
  Simulation simulation(cell, scene, fill_cell(cell, geometry(parameters), 1));
  return expect_stop(simulation, Drive{}, 2 * kSteps, "");
}

Packing crystal_in_fluid() {
  Packing packing = crystal(7, 1e-3);
  packing.scene.drag_rate = table_1().drag_rate;
  packing.scene.wall_drag = table_1().wall_drag;
  packing.state.velocity.row(0).setConstant(1e-3);
  return packing;
}

HardCase on(const std::string& what, Packing (*make)(), double factor, bool stable) {
  return {fmt::format("dt-{}-{:.2f}", what, factor),
          fmt::format("{} at dt = {:.2f} of 2/sqrt(8 k/m)", what, factor),
          stable ? "stays at rest where it is" : "stopped: the time step over its limit",
          [=](bool) {
            const Packing packing = make();
            const double time_step = factor * crystal_limit(packing.scene);
            return stable ? comes_to_rest(packing, time_step) : is_stopped(packing, time_step);
          }};
}

}  // namespace

Cases time_step_cases() {
  Cases cases;
  for (const double factor : {0.1, 0.3, 0.5, 0.7, 0.9, 0.98}) {
    cases.push_back(on("crystal", crystal_in_fluid, factor, true));
  }
  for (const double factor : {1.02, 1.1, 1.2}) {
    cases.push_back(on("crystal", crystal_in_fluid, factor, false));
  }
  // A disordered packing vibrates more slowly than a crystal, so its limit is beyond 1.
  const auto settled = [] { return settled_packing(); };
  for (const double factor : {0.1, 0.5, 0.9}) {
    cases.push_back(on("packing", settled, factor, true));
  }
  for (const double factor : {1.1, 1.2}) {
    cases.push_back(on("packing", settled, factor, false));
  }
  for (const double factor : {1.1, 1.2}) {
    cases.push_back({fmt::format("dt-loose-{:.2f}", factor),
                     fmt::format("loose grains pressed together at dt = {:.2f}", factor),
                     "stopped on the way", [factor](bool) { return stops_while_filling(factor); }});
  }
  return cases;
}

}  // namespace shearcell::stability
