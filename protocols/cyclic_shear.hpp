// SPDX-License-Identifier: GPL-3.0-or-later
// Tilts the side walls periodically (supplement B.5), without a pause or with one after each cycle.
#pragma once

#include <span>
#include <vector>

#include "protocols/protocol.hpp"

namespace shearcell {

/// When checkpoints are due: after every `every_cycles` cycles; at the `steps` of each cycle that
/// follows such a checkpoint; and at the end of the last cycle.
struct CheckpointCadence {
  std::uint64_t every_cycles = 1;
  std::vector<std::uint64_t> steps = {};  ///< since the cycle began, ascending; see steps_at()
  std::uint64_t last_cycle = 0;           ///< 0: without end
};

/// The first step after `step` at which one of the cadences has a checkpoint; 2^64 - 1 without any.
std::uint64_t next_checkpoint(std::span<const CheckpointCadence> cadences, const Drive& drive,
                              std::uint64_t step);

/// Shears for `cycles` cycles. Checkpoints are due by the cadences and at the end.
Protocol cyclic_shear(const Drive& drive, std::uint64_t cycles,
                      std::vector<CheckpointCadence> cadences);

}  // namespace shearcell
