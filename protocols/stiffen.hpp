// SPDX-License-Identifier: GPL-3.0-or-later
// Raises the spring constant of a settled packing towards hard grains (supplement B.2), in equal
// factors, and brings the packing to its minimum of enthalpy after each.
#pragma once

#include "core/minimizer.hpp"
#include "protocols/protocol.hpp"

namespace shearcell {

struct StiffenParameters {
  std::uint64_t steps_per_decade = 4;  ///< each raises k by 10^(1/steps_per_decade)
  std::uint64_t steps = 9;             ///< how many stiffnesses, k of the scene being the first
  MinimizeSettings minimize;
};

/// k_0 10^(step / steps_per_decade), with the same bits everywhere.
double raised_stiffness(double first, std::uint64_t step, std::uint64_t steps_per_decade);

/// A cycle is one stiffness: the state of cycle n has come to rest at k_0 10^((n - 1)/m), that of
/// cycle 0 is the packing as it settled. The simulation's step counts them too. No time passes.
class Stiffen final : public Protocol {
 public:
  /// `scene` holds k_0, gravity and pressure.
  Stiffen(const StiffenParameters& parameters, const Scene& scene);
  Drive drive() const override { return {}; }
  /// One whole stiffness at a time, however few steps are asked for: in the midst of a minimization
  /// there is nothing to stop at, as its course depends on more than a state.
  StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const override;
  std::uint64_t expected_steps() const override { return parameters_.steps; }

 private:
  StiffenParameters parameters_;
  Scene scene_;
};

}  // namespace shearcell
