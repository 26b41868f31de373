// SPDX-License-Identifier: GPL-3.0-or-later
// LAMMPS settles loose grains as protocols/settle does: it takes the steps between two checks, and
// our protocol decides from the resulting state whether more are needed.
#pragma once

#include <cstddef>
#include <functional>

#include "experiments/runner/lammps/lammps_run.hpp"
#include "protocols/settle.hpp"

namespace shearcell {

/// Loose grains -> at rest, by our criterion. `scene` is the protocol's; the result's step counts
/// those that LAMMPS took. The watchdog checks where the protocol does. Throws NumericalFailure as
/// the protocol does, after its time limit above all, and EngineError. `seen` gets what came back
/// after each look.
LammpsResult settle_by_lammps(const LammpsProgram& program, const Settle& protocol,
                              const Scene& scene, const Cell& cell, const State& loose,
                              std::size_t ranks,
                              const std::function<void(const State&)>& seen = {});

}  // namespace shearcell
