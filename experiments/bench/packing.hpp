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

/// The cell of these parameters with its loose grains and the scene of settling. Throws
/// GeometryError.
Packing loose_packing(const Parameters& parameters, std::uint64_t seed);

/// A loose packing pressed together without gravity: dense but not at rest, at step 0, with the
/// scene of shearing.
Packing pressed_packing(const Parameters& parameters, std::uint64_t seed);

Simulation simulate(const Packing& packing, const SimulationSettings& settings = {});

/// The state after `steps`. Throws NumericalFailure.
State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive = {});

}  // namespace shearcell::bench
