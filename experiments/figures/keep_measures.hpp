// SPDX-License-Identifier: GPL-3.0-or-later
// Measures checkpoints before their files are pruned, so that pruning never loses a number.
#pragma once

#include <vector>

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Computes and caches all measures for tables and figures, so that the files of `records` can be
/// deleted. Measures all checkpoints of the runs, because measures of a later checkpoint may need
/// the file of an earlier one. Measures them for each Ask::checkpoint_every that an experiment
/// requests. Measures that need a simulation are computed only if a manifest's figure needs them.
///
/// If a measure of a checkpoint could not be computed, the checkpoint is removed from `records`, so
/// that its file is kept; the outcome gives the reason. Exception: if the measure needs an earlier
/// checkpoint that is already pruned, the later checkpoint stays in `records`. If measures cannot
/// be cached, empties `records`. The cache is on disk when the function returns.
MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options);

}  // namespace shearcell
