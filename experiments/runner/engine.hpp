// SPDX-License-Identifier: GPL-3.0-or-later
// The engine that advances a stage: our own simulation in this process, or LAMMPS in another.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/stage.hpp"

namespace shearcell {

class Engine {
 public:
  virtual ~Engine() = default;

  /// Advances for about 50 ms and returns its progress, as Protocol::advance does. Throws
  /// NumericalFailure, and ProgramError when another program failed.
  virtual StageProgress advance() = 0;

  /// Stops before the end of the stage. No checkpoint is due if another program did not answer:
  /// then there is no state beyond the last recorded one.
  virtual StageProgress halt() = 0;

  /// The checkpoint of the newest state (of LAMMPS: its last frame). Throws NumericalFailure.
  virtual Checkpoint checkpoint(double cycle) const = 0;

  virtual std::uint64_t step() const = 0;         ///< present step
  virtual std::uint64_t evaluations() const = 0;  ///< of the forces since construction
};

/// Takes ownership of the beginning's cell and state. `lammps` computes the stage, if it is given.
std::unique_ptr<Engine> make_engine(const ReadyStage& plan, Beginning&& beginning,
                                    const Parallel& parallel,
                                    const std::optional<LammpsProgram>& lammps = std::nullopt);

/// Features of our own simulation that LAMMPS lacks or has only approximately, one sentence each.
std::vector<std::string> lammps_caveats();

}  // namespace shearcell
