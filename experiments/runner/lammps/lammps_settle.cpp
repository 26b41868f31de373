// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/lammps/lammps_settle.hpp"

#include <algorithm>
#include <utility>

namespace shearcell {

LammpsResult settle_by_lammps(const LammpsProgram& program, const Settle& protocol,
                              const Scene& scene, const Cell& cell, const State& loose,
                              std::size_t ranks, const std::function<void(const State&)>& seen) {
  LammpsResult settled{loose, 0, 0};
  for (;;) {
    // One step of our own, which is discarded: before it the protocol decides whether the packing
    // has settled, with it what acts on the grains now, and the watchdog looks at them.
    Simulation look(cell, scene, settled.state);
    if (protocol.advance(look, 1).finished) return settled;
    LammpsTask task;
    task.cell = cell;
    task.scene = look.scene();
    task.drive = protocol.drive();
    task.state = std::move(settled.state);
    task.end = task.stride = protocol.next_look(task.state.step);
    task.look = lammps_look_steps(look.grains(), ranks);
    LammpsResult part = run_lammps(program, task, ranks);
    settled.state = std::move(part.state);
    settled.loop_seconds += part.loop_seconds;
    settled.peak_bytes = std::max(settled.peak_bytes, part.peak_bytes);
    if (seen) seen(settled.state);
  }
}

}  // namespace shearcell
