// SPDX-License-Identifier: GPL-3.0-or-later
// Packings to measure with: not at rest, but dense, and made in a second.
#pragma once

#include <cstdint>

#include "core/simulation.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell::bench {

/// Grains in a cell, and the scene that acts on them.
struct Packing {
  Parameters parameters;  ///< defaults if the cell is not made from parameters
  Cell cell;
  Scene scene;
  State state;
};

/// Loose grains pressed together without gravity: dense but not at rest, at step 0, with the scene
/// of shearing. Throws GeometryError.
Packing pressed_packing(const Parameters& parameters, std::uint64_t seed);

Simulation simulate(const Packing& packing, const SimulationSettings& settings = {});

}  // namespace shearcell::bench
