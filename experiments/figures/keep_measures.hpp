// SPDX-License-Identifier: GPL-3.0-or-later
// Measures checkpoints before their files are pruned, so that pruning never loses a number.
#pragma once

#include <vector>

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Computes and caches the measures for which tables and figures may need the files of these
/// checkpoints. These are all derived measures of all checkpoints of the runs, for each cadence
/// that an experiment asks for: a later checkpoint may need an earlier one. Simulated measures are
/// computed if a figure of a registered manifest needs them. Removes from `records` each checkpoint
/// with a measure that could not be computed, unless the measure needs a file that was pruned
/// before; the outcome says why. Removes all if measures cannot be cached. The cache is on disk
/// when the function returns.
MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options);

}  // namespace shearcell
