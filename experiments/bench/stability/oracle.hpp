// SPDX-License-Identifier: GPL-3.0-or-later
// The right answers of the hard cases, independent of the engine: the contact law over all pairs
// and all images, without neighbour lists.
#pragma once

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell::stability {

/// Advances a state by `steps` of the leapfrog, at about 10 ns per pair and step.
void advance_all_pairs(const Cell& cell, const Scene& scene, const Drive& drive,
                       std::uint64_t steps, State& state);

/// Largest angular frequency [rad/s] of small vibrations about a state between upright walls at
/// rest, including the load on each contact. Power iteration: too low by a relative 1e-4 at most.
double fastest_vibration(const Cell& cell, const Scene& scene, const State& state);

/// Largest distance [d] between the positions of a grain, or of the moving wall, in two states.
double largest_difference(const State& a, const State& b);

}  // namespace shearcell::stability
