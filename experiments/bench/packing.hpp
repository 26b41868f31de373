// SPDX-License-Identifier: GPL-3.0-or-later
// Packings for benchmarks. They are dense but not at rest, and take about a second to make.
#pragma once

#include <cstdint>

#include "core/simulation.hpp"
#include "experiments/manifest/conversion.hpp"
#include "protocols/settle.hpp"

namespace shearcell::bench {

/// A cell with grains, and the forces that act on them.
struct Packing {
  Parameters parameters;  ///< default values if the cell is not made from parameters
  Cell cell;
  Scene scene;
  State state;
};

/// Makes loose grains and presses them together without gravity. The packing is dense but not at
/// rest, and its step is 0. Packing::scene is shear_scene(parameters). Throws GeometryError.
inline Packing pressed_packing(const Parameters& parameters, std::uint64_t seed) {
  const Geometry shape = geometry(parameters);
  const Cell cell = make_cell(shape, seed);
  const State loose = fill_cell(cell, shape, seed);
  return {parameters, cell, shear_scene(parameters),
          pressed(cell, loose, settle_scene(parameters))};
}

inline Simulation simulate(const Packing& packing, const SimulationSettings& settings = {}) {
  return {packing.cell, packing.scene, packing.state, settings};
}

}  // namespace shearcell::bench
