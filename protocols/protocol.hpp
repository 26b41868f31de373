// SPDX-License-Identifier: GPL-3.0-or-later
// What is done to a cell during one stage of a run.
#pragma once

#include <cstdint>
#include <functional>

#include "core/simulation.hpp"

namespace shearcell {

/// Progress of a stage after an advance.
struct StageProgress {
  double cycle = 0;             ///< cycles done; 0 for a stage without cycles
  bool checkpoint_due = false;  ///< this state must be recorded
  bool finished = false;        ///< the stage is complete; its last state must be recorded too
};

/// What is done during one stage: parameters and no state. The next action follows from the state
/// of the simulation alone, so a stage continues from any checkpoint bit for bit.
struct Protocol {
  Drive drive = {};             ///< motion of the walls
  std::uint64_t last_step = 0;  ///< at which the stage ends; 0 where it depends on the state
  /// Advances by at most `most_steps`, fewer when a checkpoint is due. Throws NumericalFailure.
  std::function<StageProgress(Simulation& simulation, std::uint64_t most_steps)> advance;
};

}  // namespace shearcell
