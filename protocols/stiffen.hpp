// SPDX-License-Identifier: GPL-3.0-or-later
// Raises the spring constant of a settled packing by equal factors (hard-grain limit, supplement
// B.2) and minimizes the enthalpy after each factor.
#pragma once

#include "core/minimizer.hpp"
#include "protocols/protocol.hpp"

namespace shearcell {

struct StiffenParameters {
  std::uint64_t steps_per_decade = 4;  ///< each step multiplies k by 10^(1/steps_per_decade)
  std::uint64_t steps = 9;             ///< number of stiffness values; the first is k of the scene
  MinimizeSettings minimize;
};

/// Returns first * 10^(step / steps_per_decade), with the same bits on every machine.
double raised_stiffness(double first, std::uint64_t step, std::uint64_t steps_per_decade);

/// Cycle 0 is the settled packing. In each further cycle n, the packing comes to rest with the
/// stiffness k_0 10^((n - 1)/m), where m is `steps_per_decade`. The step number of the simulation
/// counts the cycles; no simulated time passes. `scene` holds k_0, gravity and pressure. Each call
/// of advance() does one whole minimization, because a State cannot hold an unfinished one.
Protocol stiffen(const StiffenParameters& parameters, const Scene& scene);

}  // namespace shearcell
