// SPDX-License-Identifier: GPL-3.0-or-later
// Where a run ends for one of the experiments that share it.
#pragma once

#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// The last cycle of the run that counts for this experiment: its number of cycles, or where its
/// `until` ends the run. Another experiment may have continued it; an experiment's figures and
/// tables are the same whatever shares its runs. May measure checkpoints, and keeps the results.
/// Throws StoreDamaged where the run's declarations are not as this program writes them.
double own_end(const Store& store, const RunRecord& run, const Membership& membership,
               const MeasureOptions& options);

}  // namespace shearcell
