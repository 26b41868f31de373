// SPDX-License-Identifier: GPL-3.0-or-later
// The engine that advances a stage: our own simulation in this process, or LAMMPS in another.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/stage.hpp"

namespace shearcell {

class Engine {
 public:
  virtual ~Engine() = default;

  /// Advances for about 50 ms and returns its progress, as Protocol::advance does. Throws
  /// NumericalFailure, and ProgramError when another program failed.
  virtual StageProgress advance() = 0;

  /// Ends before the stage does. No checkpoint is due if another program did not answer, so that
  /// there is no state beyond the last recorded one.
  virtual StageProgress halt() = 0;

  /// The checkpoint of the state after the last of these calls, or of the beginning. Throws
  /// NumericalFailure.
  virtual Checkpoint checkpoint(double cycle) const = 0;

  virtual std::uint64_t step() const = 0;         ///< where it is
  virtual std::uint64_t evaluations() const = 0;  ///< of the forces since construction
};

/// The program that computes a stage of LAMMPS; nothing for one of ours. Throws as find_lammps().
std::optional<LammpsProgram> find_engine(const StagePlan& plan, const Parallel& parallel);

/// Takes ownership of the beginning's cell and state. `lammps` computes the stage where it is one.
std::unique_ptr<Engine> make_engine(const StagePlan& plan, Beginning&& beginning,
                                    const Parallel& parallel,
                                    const std::optional<LammpsProgram>& lammps = std::nullopt);

/// What an attempt records of it beside the host.
nlohmann::json engine_facts(const LammpsProgram& lammps, const Parallel& parallel);

/// Features of our own simulation that LAMMPS lacks or has only approximately, one sentence each.
std::vector<std::string> lammps_caveats();

}  // namespace shearcell
