// SPDX-License-Identifier: GPL-3.0-or-later
// Measures checkpoints before their files are pruned, so that pruning never loses a number.
#pragma once

#include <vector>

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Computes what tables and figures may need of these checkpoints' files and caches it: every
/// derived measure of all checkpoints of their runs, since a later checkpoint may need an earlier
/// one, for each cadence that an experiment asks for; and the simulated measures that a figure of a
/// registered manifest needs. Removes from `records` those with a measure that could not be
/// computed, unless it needs a file that was pruned before; the outcome says why. Removes all if
/// measures cannot be cached. The cache is on disk when this returns.
MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options);

}  // namespace shearcell
