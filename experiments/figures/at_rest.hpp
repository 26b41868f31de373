// SPDX-License-Identifier: GPL-3.0-or-later
// phi of packings at rest, for protocols whose checkpoints are recorded at different shear rates.
#pragma once

#include <span>
#include <vector>

#include "experiments/figures/measure.hpp"

namespace shearcell {

/// phi (Eq. S4) of each checkpoint after 0.1 s between held walls (protocols/rest.hpp), in the
/// order of the records. Not a number for a checkpoint that could not be read, and outside cycles 1
/// to early_cycles. Values are kept like other measures.
std::vector<double> phi_at_rest(const Store& store, std::span<const CheckpointRecord> records,
                                const MeasureOptions& options);

}  // namespace shearcell
