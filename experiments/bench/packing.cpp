// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/packing.hpp"

#include "experiments/manifest/conversion.hpp"
#include "protocols/settle.hpp"

namespace shearcell::bench {

Packing pressed_packing(const Parameters& parameters, std::uint64_t seed) {
  const Geometry shape = geometry(parameters);
  Packing packing{parameters, make_cell(shape, seed), shear_scene(parameters), {}};
  packing.state =
      pressed(packing.cell, fill_cell(packing.cell, shape, seed), settle_scene(parameters));
  return packing;
}

Simulation simulate(const Packing& packing, const SimulationSettings& settings) {
  return {packing.cell, packing.scene, packing.state, settings};
}

}  // namespace shearcell::bench
