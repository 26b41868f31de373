// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocols/rest.hpp"

#include <cmath>

namespace shearcell {

State rested(const Cell& cell, const Scene& scene, State state, double seconds) {
  const auto steps = static_cast<std::uint64_t>(std::llround(seconds / scene.time_step));
  // The drive has a cycle of one step and then a pause. Starting at step 1 skips the cycle.
  const Drive pause{.amplitude = 0, .steps_per_cycle = 1, .pause_steps = steps};
  state.step = 1;
  Simulation simulation(cell, scene, state);
  simulation.set_overlap_limit(kLargestOverlapLimit);
  simulation.advance(pause, steps);
  state = simulation.state();
  state.step = 0;
  return state;
}

}  // namespace shearcell
