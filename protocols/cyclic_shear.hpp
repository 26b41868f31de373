// SPDX-License-Identifier: GPL-3.0-or-later
// Tilts the side walls periodically (supplement B.5), without a pause or with one after each cycle.
#pragma once

#include <span>
#include <vector>

#include "protocols/protocol.hpp"

namespace shearcell {

/// When checkpoints are due: after every `every_cycles` cycles, at the `steps` of each cycle that
/// follows such a checkpoint, and at the end of the last cycle.
struct CheckpointCadence {
  std::uint64_t every_cycles = 1;
  std::vector<std::uint64_t> steps = {};  ///< since the cycle began, ascending; see steps_at()
  std::uint64_t last_cycle = 0;           ///< 0: without end
};

/// The first step after `step` at which one of the cadences has a checkpoint; 2^64 - 1 without any.
std::uint64_t next_checkpoint(std::span<const CheckpointCadence> cadences, const Drive& drive,
                              std::uint64_t step);

class CyclicShear final : public Protocol {
 public:
  /// Shears for `cycles` cycles. Checkpoints are due after every `checkpoint_cycles` cycles and by
  /// the cadences `more`.
  CyclicShear(const Drive& drive, std::uint64_t cycles, std::uint64_t checkpoint_cycles,
              std::vector<CheckpointCadence> more = {});
  Drive drive() const override { return drive_; }
  StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const override;
  std::uint64_t last_step() const override { return cycles_ * cycle_steps(drive_); }

 private:
  Drive drive_;
  std::uint64_t cycles_;
  std::vector<CheckpointCadence> cadences_;
};

}  // namespace shearcell
