// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of checkpoints, including those that need more than an analysis of positions: the shear
// at that instant, the energies of the cycle before, and phi at rest.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/runner/measure.hpp"

namespace shearcell {

struct MeasuredPackings : MeasureOutcome {
  /// In the order of the records; empty for a checkpoint that could not be read.
  std::vector<std::optional<Measures>> measures;
};

/// Whether a measure is computed by a simulation that begins at the checkpoint: "ledger",
/// "at_rest".
bool is_simulated(const std::string& name);

/// Measures checkpoints. `names` are derived measures (derived_measures.hpp), "drive", "ledger" or
/// "at_rest" (phi_at_rest of cycles 1 to early_cycles). Units and drive of the runs are always
/// added. "ledger" and "at_rest" are simulated; results are cached. They are left out where the
/// simulation fails, as a measure that needs an earlier checkpoint is if that cannot be read.
/// Throws AnalysisError if the cache is malformed.
MeasuredPackings measures_of(const Store& store, std::span<const CheckpointRecord> records,
                             std::span<const std::string> names, const MeasureOptions& options);

/// Adds the shear strain and its rate at a checkpoint of a shear.
void add_drive(const RunRecord& run, const CheckpointRecord& checkpoint, Measures& measures);

}  // namespace shearcell
