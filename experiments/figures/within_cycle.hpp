// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of checkpoints that need no positions: the shear at one instant, and the energy of the
// cycle before.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "experiments/figures/measure.hpp"

namespace shearcell {

/// Steps between two samples of an energy ledger: a period of the fastest vibration at Table I's
/// time step.
inline constexpr std::uint64_t kLedgerStride = 8;

/// Adds the shear strain and its rate at a checkpoint of a shear.
void add_drive(const RunRecord& run, const CheckpointRecord& checkpoint, Measures& measures);

/// Of all grains and the moving wall [J] (protocols/ledger.hpp).
struct CycleEnergy {
  double work_of_walls = std::numeric_limits<double>::quiet_NaN();
  double dissipation = std::numeric_limits<double>::quiet_NaN();
  double stored = std::numeric_limits<double>::quiet_NaN();
};
void add_energy(const CycleEnergy& energy, Measures& measures);

/// The energy of the cycle that ends at each checkpoint, in the order of the records: simulated
/// again from the checkpoint one cycle earlier, which takes three to four times as long as the
/// cycle did (protocols/ledger.hpp), and kept like other measures. Not a number within a cycle, and
/// where that earlier checkpoint was never made or cannot be read.
std::vector<CycleEnergy> cycle_energies(const Store& store,
                                        std::span<const CheckpointRecord> records,
                                        const MeasureOptions& options);

}  // namespace shearcell
