// SPDX-License-Identifier: GPL-3.0-or-later
// What a state should do, by other means than the engine's: each pair with each of its images, the
// contact law as it is written on paper, the C library's tangent, no lists, no order of summation.
#pragma once

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell::stability {

/// Advances a state by `steps` of the leapfrog (core/simulation.hpp). Takes about 10 ns for each
/// pair and step: for small cells.
void advance_all_pairs(const Cell& cell, const Scene& scene, const Drive& drive,
                       std::uint64_t steps, State& state);

/// Largest angular frequency [rad/s] of small vibrations about a state between upright walls that
/// stand still, the load on each contact included; by power iteration, from below to about 1e-4.
double fastest_vibration(const Cell& cell, const Scene& scene, const State& state);

/// Largest distance [d] of a grain from where it is in the other state, and of the moving wall.
double largest_difference(const State& a, const State& b);

}  // namespace shearcell::stability
