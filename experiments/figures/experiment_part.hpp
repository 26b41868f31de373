// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a shared run that belongs to one experiment.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "experiments/runner/asks.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/limits.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Steps of a shear at which `ask` wants a checkpoint, in cycles `first` to `last`. Empty for
/// another kind of run, and for a record that this program cannot read.
std::vector<std::uint64_t> asked_steps(const RunRecord& run, const RunAsk& ask, double first,
                                       double last);

/// The checkpoints of cycles `first` to `last`, including pruned ones, that one of `asks` wants: on
/// its cadence, at its phases and at its last cycle. For another kind of run, or without `asks`,
/// all at whole cycles. Checkpoints that interruptions and other experiments left are not included,
/// so that figures and tables do not depend on them.
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const RunRecord& run,
                                              std::span<const RunAsk> asks, double first = 0,
                                              double last = StoreLimits::cycles);

/// The checkpoints of one experiment, up to end_for().
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const RunRecord& run,
                                              const Membership& membership,
                                              const MeasureOptions& options);

}  // namespace shearcell
