// SPDX-License-Identifier: GPL-3.0-or-later
// Measures checkpoints before their files are pruned, so that pruning never loses a number.
#pragma once

#include <vector>

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Computes and caches all measures for tables and figures, so that the files of `records` can be
/// deleted. Measures all checkpoints of the runs, because a later one may need an earlier file.
/// Does so for each interval between checkpoints that an experiment requests. Simulated measures
/// are computed only if a figure of a manifest needs them.
///
/// Removes from `records` each checkpoint with a measure that could not be computed; the outcome
/// gives the reason. If this measure needs the file of an earlier checkpoint that is already
/// pruned, the checkpoint is not removed. If measures cannot be cached, removes all records. The
/// cache is on disk when the function returns.
MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options);

}  // namespace shearcell
