// SPDX-License-Identifier: GPL-3.0-or-later
// Measures checkpoints before their files are pruned, so that pruning never loses a number.
#pragma once

#include <vector>

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Computes and caches all measures for tables and figures, so that the files of `records` can be
/// deleted. All checkpoints of the runs are measured, because a measure of a later checkpoint may
/// need the file of an earlier one. Measures that depend on Ask::checkpoint_every are computed
/// for each value that an experiment requests. A measure that needs a simulation is computed only
/// if a figure of a manifest needs it.
///
/// On return, `records` lists the checkpoints whose files can be deleted. A checkpoint is removed
/// from `records` if one of its measures could not be computed; the outcome gives the reason.
/// Exception: a checkpoint stays in `records` if the measure also needs an earlier checkpoint that
/// is already pruned, because then the measure can no longer be computed. If measures cannot be
/// cached, `records` becomes empty. The cache is on disk when the function returns.
MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options);

}  // namespace shearcell
