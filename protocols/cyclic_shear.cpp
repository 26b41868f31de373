// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocols/cyclic_shear.hpp"

#include <algorithm>

namespace shearcell {

CyclicShear::CyclicShear(const Drive& drive, std::uint64_t cycles, std::uint64_t checkpoint_cycles)
    : drive_(drive),
      cycles_(cycles),
      checkpoint_cycles_(std::max<std::uint64_t>(1, checkpoint_cycles)) {}

StageProgress CyclicShear::advance(Simulation& simulation, std::uint64_t most_steps) const {
  const std::uint64_t end = expected_steps();
  const std::uint64_t stride = checkpoint_cycles_ * cycle_steps(drive_);
  const std::uint64_t step = simulation.step();
  if (step < end) {
    const std::uint64_t to_checkpoint = stride - step % stride;
    simulation.advance(drive_, std::min({most_steps, to_checkpoint, end - step}));
  }
  StageProgress progress;
  progress.cycle =
      static_cast<double>(simulation.step()) / static_cast<double>(cycle_steps(drive_));
  progress.finished = simulation.step() >= end;
  progress.checkpoint_due = progress.finished || simulation.step() % stride == 0;
  return progress;
}

}  // namespace shearcell
