// SPDX-License-Identifier: GPL-3.0-or-later
// Tilts the side walls periodically (supplement B.5), without a pause or with one after each cycle.
#pragma once

#include "protocols/protocol.hpp"

namespace shearcell {

class CyclicShear final : public Protocol {
 public:
  /// Shears for `cycles` cycles; a checkpoint is due after every `checkpoint_cycles` of them.
  CyclicShear(const Drive& drive, std::uint64_t cycles, std::uint64_t checkpoint_cycles);
  Drive drive() const override { return drive_; }
  StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const override;
  std::uint64_t expected_steps() const override { return cycles_ * cycle_steps(drive_); }

 private:
  Drive drive_;
  std::uint64_t cycles_;
  std::uint64_t checkpoint_cycles_;
};

}  // namespace shearcell
