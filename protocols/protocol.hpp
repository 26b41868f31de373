// SPDX-License-Identifier: GPL-3.0-or-later
// A protocol defines what happens to a cell during one stage of a run.
#pragma once

#include <cstdint>
#include <functional>

#include "core/simulation.hpp"

namespace shearcell {

/// Progress of a stage after a call of Protocol::advance.
struct StageProgress {
  double cycle = 0;             ///< cycles done; 0 for a stage without cycles
  bool checkpoint_due = false;  ///< this state must be recorded
  bool finished = false;        ///< the stage is complete, and this state must be recorded
};

/// Defines one stage. A protocol has parameters but no state. The next action depends only on the
/// state of the simulation, so a stage continues from any checkpoint bit for bit.
struct Protocol {
  Drive drive = {};             ///< motion of the walls
  std::uint64_t last_step = 0;  ///< last step of the stage; 0 if the end depends on the state
  /// Advances by at most `most_steps` and stops when a checkpoint is due. Throws NumericalFailure.
  std::function<StageProgress(Simulation& simulation, std::uint64_t most_steps)> advance;
};

}  // namespace shearcell
