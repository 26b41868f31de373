// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocols/cyclic_shear.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace shearcell {

std::uint64_t next_checkpoint(std::span<const CheckpointCadence> cadences, const Drive& drive,
                              std::uint64_t step) {
  std::uint64_t next = std::numeric_limits<std::uint64_t>::max();
  for (const CheckpointCadence& cadence : cadences) {
    const std::uint64_t last = cadence.last_cycle * cycle_steps(drive);
    if (last > 0 && step >= last) continue;
    const std::uint64_t stride =
        std::max<std::uint64_t>(1, cadence.every_cycles) * cycle_steps(drive);
    const std::uint64_t begin = step - step % stride;
    const auto later = std::ranges::upper_bound(cadence.steps, step - begin);
    next = std::min(next, begin + (later == cadence.steps.end() ? stride : *later));
    if (last > 0) next = std::min(next, last);
  }
  return next;
}

Protocol cyclic_shear(const Drive& drive, std::uint64_t cycles,
                      std::vector<CheckpointCadence> cadences) {
  const std::uint64_t end = cycles * cycle_steps(drive);
  const auto advance = [drive, end, cadences = std::move(cadences)](
                           Simulation& simulation, std::uint64_t most_steps) -> StageProgress {
    const std::uint64_t step = simulation.step();
    const std::uint64_t due = next_checkpoint(cadences, drive, step);
    if (step < end) simulation.advance(drive, std::min({most_steps, due - step, end - step}));
    const bool finished = simulation.step() >= end;
    const auto per_cycle = static_cast<double>(cycle_steps(drive));
    return {.cycle = static_cast<double>(simulation.step()) / per_cycle,
            .checkpoint_due = finished || simulation.step() == due,
            .finished = finished};
  };
  return {drive, end, advance};
}

}  // namespace shearcell
