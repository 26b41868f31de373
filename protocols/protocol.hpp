// SPDX-License-Identifier: GPL-3.0-or-later
// The interface of protocols: what is done to a cell during one stage of a run.
#pragma once

#include <cstdint>

#include "core/simulation.hpp"

namespace shearcell {

/// Progress of a stage after an advance.
struct StageProgress {
  double cycle = 0;             ///< cycles done; 0 for a stage without cycles
  bool checkpoint_due = false;  ///< this state must be recorded
  bool finished = false;        ///< the stage is complete; its last state must be recorded too
};

/// A protocol has parameters and no state. Its next action follows from the state of the simulation
/// alone, so a stage continues from any checkpoint bit for bit.
class Protocol {
 public:
  virtual ~Protocol() = default;

  /// Motion of the walls during the stage.
  virtual Drive drive() const = 0;

  /// Advances by at most `most_steps`, fewer when a checkpoint is due. Throws NumericalFailure.
  virtual StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const = 0;

  /// The step at which the stage ends; 0 where it depends on the state.
  virtual std::uint64_t last_step() const = 0;
};

}  // namespace shearcell
