// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a run that belongs to one of the experiments that share it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "experiments/runner/asks.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/limits.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Steps of a shear at which `ask` wants a checkpoint in cycles first to last; none of another
/// kind of run, or of a record that this program cannot read.
std::vector<std::uint64_t> asked_steps(const RunRecord& run, const RunAsk& ask, double first,
                                       double last);

/// The checkpoints of cycles first to last, pruned ones too, that one of `asks` has: on its
/// cadence, at its phases and at its last cycle; of another kind of run all at whole cycles.
/// Interruptions and other experiments leave more, which no figure or table has: they would differ
/// from those of a run that was never interrupted and that nobody shares.
std::vector<CheckpointRecord> own_checkpoints(const Store& store, const RunRecord& run,
                                              std::span<const RunAsk> asks, double first = 0,
                                              double last = StoreLimits::cycles);

/// Those of one experiment, up to own_end().
std::vector<CheckpointRecord> own_checkpoints(const Store& store, const RunRecord& run,
                                              const Membership& membership,
                                              const MeasureOptions& options);

}  // namespace shearcell
