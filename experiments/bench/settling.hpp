// SPDX-License-Identifier: GPL-3.0-or-later
// One loose filling settled by our engine, and by LAMMPS: two packings, since grains that collide
// forget where they came from, but of one kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/bench/accuracy/sheared.hpp"
#include "experiments/bench/packing_numbers.hpp"
#include "protocols/settle.hpp"

namespace shearcell {

struct Settling {
  State state;                                   ///< settled; its step counts from the loose grains
  double seconds = 0;                            ///< wall time, of everything
  double million_particle_steps_per_second = 0;  ///< of LAMMPS in its time loop alone
  double bytes = 0;  ///< ours: of the simulation; LAMMPS: of its largest process
  PackingNumbers numbers;
};

/// The cell and the loose grains of a seed. Throws GeometryError.
accuracy::Packing loose_packing(const Parameters& parameters, std::uint64_t seed);

/// Throw NumericalFailure, above all when a packing is not settled after the time limit, and
/// EngineError. `seen` gets what LAMMPS has, every 0.1 s of simulated time.
Settling settling_by_us(const accuracy::Packing& loose, const SettleParameters& settle);
Settling settling_by_lammps(const accuracy::Packing& loose, const SettleParameters& settle,
                            const LammpsProgram& program, std::size_t ranks,
                            const std::function<void(const State&)>& seen = {});

}  // namespace shearcell
