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
/// "drive", "ledger" or "at_rest" (phi_at_rest of cycles 1 to early_cycles), with the units and the
/// drive of their runs. What needs an earlier checkpoint that cannot be read is left out. The last
/// two are simulated, and kept like the others. Throws AnalysisError where a kept result is
/// something else.
MeasuredPackings measures_of(const Store& store, std::span<const CheckpointRecord> records,
                             std::span<const std::string> names, const MeasureOptions& options);

/// Adds the shear strain and its rate at a checkpoint of a shear.
void add_drive(const RunRecord& run, const CheckpointRecord& checkpoint, Measures& measures);

}  // namespace shearcell
