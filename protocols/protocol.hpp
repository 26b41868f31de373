// SPDX-License-Identifier: GPL-3.0-or-later
// What is done to a cell during one stage of a run: the interface that every protocol fills in.
#pragma once

#include <cstdint>

#include "core/simulation.hpp"

namespace shearcell {

/// Where a stage stands after an advance.
struct StageProgress {
  double cycle = 0;             ///< cycles done; stays 0 for a stage that has none
  bool checkpoint_due = false;  ///< a state that the stage promises to record
  bool finished = false;        ///< nothing is left to do; the last state is due as well
};

/// A protocol holds parameters and no state: what it does next follows from the simulation's state
/// alone, so a stage continues from any checkpoint as if it had never stopped.
class Protocol {
 public:
  virtual ~Protocol() = default;

  /// Drive of the walls during the stage.
  virtual Drive drive() const = 0;

  /// Advances by at most `most_steps`, stopping early where a checkpoint is due. The stage need not
  /// be looked at between calls. Throws NumericalFailure.
  virtual StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const = 0;

  /// Expected length of the whole stage in steps, for estimates; 0 when it is not known.
  virtual std::uint64_t expected_steps() const = 0;
};

}  // namespace shearcell
