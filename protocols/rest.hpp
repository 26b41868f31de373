// SPDX-License-Identifier: GPL-3.0-or-later
// Lets a packing come to rest, so that packings recorded at different shear rates can be compared.
#pragma once

#include "core/simulation.hpp"

namespace shearcell {

/// Returns the state after `seconds` of rest under the forces of the scene, between upright walls
/// that are held in place. States of continuous shear are recorded when the shear rate is
/// largest in the cycle. States of paused shear are recorded after a pause (supplement B.5). After
/// equal times of rest, states of both kinds can be compared. The result depends only on the
/// arguments and has step 0. Throws NumericalFailure.
State rested(const Cell& cell, const Scene& scene, State state, double seconds);

}  // namespace shearcell
