// SPDX-License-Identifier: GPL-3.0-or-later
// Measures checkpoints before their files are pruned, so that pruning never loses a number.
#pragma once

#include <vector>

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Computes and caches the measures for tables and figures that need the files of `records`. These
/// are all derived measures of all checkpoints of the runs, because a later checkpoint's measure
/// may need an earlier file. They are computed at each checkpoint cadence that an experiment asks
/// for. Simulated measures are computed if a figure of a manifest needs them.
///
/// Removes from `records` each checkpoint with a measure that could not be computed; the outcome
/// gives the reason. A checkpoint stays in `records` if the measure also needs the file of an
/// earlier checkpoint that is already pruned. If measures cannot be cached, removes all records.
/// The cache is on disk when the function returns.
MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options);

}  // namespace shearcell
