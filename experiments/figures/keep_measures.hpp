// SPDX-License-Identifier: GPL-3.0-or-later
// Measures checkpoints before their files are pruned, so that pruning never loses a number.
#pragma once

#include <vector>

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Computes and caches the measures that tables and figures may ask for and that need the files of
/// these checkpoints: all derived measures of all checkpoints of their runs, since a measure of a
/// later checkpoint may need an earlier file, at each cadence that an experiment asks for.
/// Simulated measures are computed if a figure of a registered manifest needs them.
///
/// Removes from `records` each checkpoint with a measure that could not be computed; the outcome
/// says why. A checkpoint stays if the measure needs another file, which was pruned before. Removes
/// all records if measures cannot be cached. The cache is on disk when the function returns.
MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options);

}  // namespace shearcell
