// SPDX-License-Identifier: GPL-3.0-or-later
// One stage of a run, made from its record and ready to be stepped. A first computation, a
// continuation and a replay all use it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/simulation.hpp"
#include "experiments/manifest/identity.hpp"
#include "protocols/protocol.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Threads and processes of one stage.
struct Parallel {
  std::size_t threads = 1;  ///< of our own simulation; results do not depend on it
  std::size_t ranks = 1;    ///< processes of LAMMPS, under mpirun when more than one
};

/// The scene and the protocol of a stage.
struct ReadyStage {
  Stage run;
  StageInputs stage;
  Scene scene;
  std::unique_ptr<Protocol> protocol;
};

/// The watchdog's overlap limit is the largest that a manifest of the run states. Throws
/// StoreDamaged when the recorded parameters do not give the run's id.
ReadyStage ready_stage(const Store& store, Stage run);

/// The state from which a stage is stepped on.
struct Beginning {
  Cell cell;
  State state;
  std::optional<CheckpointRecord> from;  ///< checkpoint of this stage that it continues
  std::string parent_checkpoint;         ///< that the stage begins from, or ""
};

/// The newest valid checkpoint before a step. Without one, the beginning of the stage: the state at
/// which its parent was completed, or a fresh filling. Throws StoreDamaged when the parent's state
/// cannot be read or the parent is not completed, and Interrupted when a stop is requested during
/// the filling.
/// `damage` as in Store::newest_valid_checkpoint.
Beginning continue_stage(Store& store, const ReadyStage& plan, std::vector<std::string>* damage,
                         std::uint64_t before_step = UINT64_MAX);

/// Takes ownership of the beginning's cell and state.
Simulation make_simulation(const ReadyStage& plan, Beginning&& beginning, std::size_t threads);

/// Steps between two checks for signals and leases: about 50 ms of work.
std::uint64_t chunk_steps(std::size_t grains);

/// The checkpoint of the present state; it depends on the state alone. Throws NumericalFailure for
/// an invalid state.
Checkpoint make_checkpoint(const ReadyStage& plan, const Simulation& simulation, double cycle);

/// The same for a state that another engine computed; `scene` acts on it now.
Checkpoint make_checkpoint(const ReadyStage& plan, const Cell& cell, const Scene& scene,
                           const State& state, double cycle);

}  // namespace shearcell
