// SPDX-License-Identifier: GPL-3.0-or-later
// A packing at rest, to compare packings that were recorded at different rates of shear.
#pragma once

#include "core/simulation.hpp"

namespace shearcell {

/// The state `seconds` later, between upright walls that are held in place, under the forces of the
/// scene. Continuous shear is recorded at its largest shear rate and paused shear at the end of a
/// pause (supplement B.5); after the same rest, measures of both can be compared. The result
/// depends only on the arguments; its step is 0. Throws NumericalFailure.
State rested(const Cell& cell, const Scene& scene, State state, double seconds);

}  // namespace shearcell
