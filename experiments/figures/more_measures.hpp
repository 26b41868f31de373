// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of checkpoints, those that an analysis of their positions does not give included: the
// shear at that instant, the energy of the cycle before, and phi at rest.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/runner/measure.hpp"

namespace shearcell {

struct MeasuredPackings : MeasureOutcome {
  /// In the order of the records; nothing for a checkpoint that could not be read.
  std::vector<std::optional<Measures>> measures;
};

/// Measures of checkpoints: those of `names`, which are derived measures (derived_measures.hpp),
/// "drive", "ledger" or "at_rest", with the units and the drive of their runs. What needs an
/// earlier checkpoint that cannot be read is left out. Throws AnalysisError where a kept result is
/// something else.
MeasuredPackings measures_of(const Store& store, std::span<const CheckpointRecord> records,
                             std::span<const std::string> names, const MeasureOptions& options);

/// Adds the shear strain and its rate at a checkpoint of a shear.
void add_drive(const RunRecord& run, const CheckpointRecord& checkpoint, Measures& measures);

/// Measures::numbers of the energy of all grains and the moving wall in the cycle that ends at each
/// checkpoint, in the order of the records: simulated again from the checkpoint one cycle earlier,
/// which takes three to four times as long as the cycle did (protocols/ledger.hpp), and kept like
/// other measures. None within a cycle, and where that earlier checkpoint was never made or cannot
/// be read.
std::vector<decltype(Measures::numbers)> cycle_energies(const Store& store,
                                                        std::span<const CheckpointRecord> records,
                                                        const MeasureOptions& options);

/// phi (Eq. S4) of each checkpoint after 0.1 s between held walls (protocols/rest.hpp), for
/// protocols whose checkpoints are recorded at different shear rates; in the order of the records.
/// Not a number for a checkpoint that could not be read, and outside cycles 1 to early_cycles.
/// Values are kept like other measures.
std::vector<double> phi_at_rest(const Store& store, std::span<const CheckpointRecord> records,
                                const MeasureOptions& options);

}  // namespace shearcell
