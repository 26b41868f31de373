// SPDX-License-Identifier: GPL-3.0-or-later
// Tilts the side walls periodically (supplement B.5), with or without a pause after each cycle.
#pragma once

#include <span>
#include <vector>

#include "protocols/protocol.hpp"

namespace shearcell {

/// Each period of `every_cycles` cycles ends with a checkpoint, and the first cycle of each period
/// has checkpoints at `steps`. The last checkpoint is at the end of `last_cycle`.
struct CheckpointCadence {
  std::uint64_t every_cycles = 1;
  std::vector<std::uint64_t> steps = {};  ///< steps of the cycle, ascending; see steps_at()
  std::uint64_t last_cycle = 0;           ///< 0: the schedule does not end
};

/// First step after `step` with a checkpoint of any cadence; 2^64 - 1 if there is no such step.
std::uint64_t next_checkpoint(std::span<const CheckpointCadence> cadences, const Drive& drive,
                              std::uint64_t step);

/// Shears for `cycles` cycles. Checkpoints are due at the steps of the cadences and at the end.
Protocol cyclic_shear(const Drive& drive, std::uint64_t cycles,
                      std::vector<CheckpointCadence> cadences);

}  // namespace shearcell
