// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/packing.hpp"

#include "experiments/manifest/conversion.hpp"
#include "protocols/settle.hpp"

namespace shearcell::bench {

Packing loose_packing(const Parameters& parameters, std::uint64_t seed) {
  Packing packing{parameters, make_cell(geometry(parameters), seed), settle_scene(parameters), {}};
  packing.state = fill_cell(packing.cell, geometry(parameters), seed);
  return packing;
}

Packing pressed_packing(const Parameters& parameters, std::uint64_t seed) {
  Packing packing = loose_packing(parameters, seed);
  packing.state = pressed(packing.cell, packing.state, packing.scene);
  packing.scene = shear_scene(parameters);
  return packing;
}

Simulation simulate(const Packing& packing, const SimulationSettings& settings) {
  return {packing.cell, packing.scene, packing.state, settings};
}

State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive) {
  Simulation simulation = simulate(packing);
  simulation.advance(drive, steps);
  return simulation.state();
}

}  // namespace shearcell::bench
