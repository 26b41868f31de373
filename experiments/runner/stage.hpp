// SPDX-License-Identifier: GPL-3.0-or-later
// Computes one stage from its record in the store and records the result. Recomputes recorded
// states, to verify them or to restore their files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "experiments/manifest/parameters.hpp"
#include "provenance/lineage.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct Parallel {
  std::size_t threads = 1;  ///< of this program's engine; results do not depend on the number
  std::size_t ranks = 1;    ///< LAMMPS processes; if more than one, they run under mpirun
};

/// How run_stage() ended. `already`: nothing was left to compute. `lost`: another process computes
/// the stage, has completed it, or has recorded a later state.
enum class StageOutcome : std::uint8_t { completed, already, interrupted, failed, lost };

struct StageOptions {
  Parallel parallel = {};
  bool restores = true;  ///< recompute a pruned checkpoint if the stage needs its file
  std::function<void(const std::string&)> damaged = {};  ///< called for each damaged checkpoint
  std::function<void()> begun = {};                      ///< called after the start is recorded
  /// Called if the stage continues from a state that this build cannot recompute bit for bit.
  std::function<void(const std::string&)> continuing = {};
  /// Called before a pruned checkpoint is recomputed because the stage needs it.
  std::function<void(const std::string&)> restoring = {};
  /// Called a few times per second with a text: the cycle or step, the speed and the time left.
  std::function<void(const std::string&)> report = {};
};

/// Computes the stage `id` up to its target, and then its missing earlier checkpoints. Starts from
/// the newest valid checkpoint. Without one, starts from a state of the parent, or fills a new
/// cell. If the starting state was pruned, its file is restored first. About every 50 ms,
/// checks stop_requested() and whether this program still holds the stage. If a stop is requested
/// while the new cell is being filled, nothing is recorded. These errors are thrown before anything
/// is recorded: StoreDamaged if the starting state is damaged, or if the id is not the hash of the
/// recorded parameters; NotFound if the stage needs a starting_state(), but there is none;
/// FilePruned if the starting state was pruned and cannot be recomputed; GeometryError if the cell
/// cannot be filled; TooLittleMemory; ProgramError if the stage's engine is not installed.
StageOutcome run_stage(Store& store, const std::string& id, const StageOptions& options);

/// True if the stage is done (Outlook::done) and its last checkpoint can be read or was pruned.
bool is_done(const Store& store, const Stage& stage);

/// The parent's checkpoint that the stage starts from, even if this checkpoint was pruned. If the
/// parent is a packing: its last checkpoint. If the parent is a shear: its checkpoint at cycle
/// `start_cycle`. Empty if this checkpoint was never recorded, or if the packing has not settled.
std::optional<CheckpointRecord> starting_state(const Store& store, const Stage& stage,
                                               const Parameters& parameters);

/// Where a recomputed checkpoint differs from the recorded checkpoint.
struct Divergence {
  std::uint64_t same_step = 0;   ///< last step at which the two computations are known to agree
  std::uint64_t first_step = 0;  ///< first step at which a difference was found
  /// The part that differs. If the states differ: "position", "velocity", "wall_height" or
  /// "wall_velocity". If the states are equal: "cycle", "time_s", "theta", the name of an
  /// observable, or "file" (the bytes of the file). "" if unknown.
  std::string field;
  std::int64_t grain = -1;
  std::uint64_t ulp = 0;  ///< largest difference in `field` [units in the last place]
  std::string message;
};

nlohmann::json to_json(const Divergence& divergence);

struct Replay {
  CheckpointRecord record;
  std::optional<CheckpointRecord> from = {};  ///< empty if the replay began at step 0
  std::uint64_t steps = 0;                    ///< number of recomputed steps
  std::optional<Divergence> divergence = {};
  bool interrupted = false;  ///< whether a signal stopped the replay; then nothing is recorded
};

/// Why this build cannot recompute the checkpoint bit for bit; empty if it can. `known` caches
/// lineages from the log for further calls.
std::optional<std::string> why_not_again(const Store& store, const CheckpointRecord& record,
                                         RunLineages& known);

/// Recomputes a checkpoint from the nearest earlier checkpoint whose file exists, or from the
/// beginning of the stage. Compares the recomputed state, cycle, time, tilt and observables with
/// the recorded ones, and records ReplayVerified or ReplayDiverged. Throws FilePruned if the replay
/// would have to start from a state of the parent stage, and the file of this state was pruned.
Replay verify_by_replay(Store& store, const CheckpointRecord& record, std::size_t threads = 1);

/// Recomputes a checkpoint as verify_by_replay() does, and restores a pruned, missing or damaged
/// file. If the new bytes do not have the recorded SHA-256, records ReplayDiverged and writes no
/// file. If the replay needs a pruned state of the parent stage, restores this state first.
Replay regenerate_checkpoint(Store& store, const CheckpointRecord& record, std::size_t threads = 1);

}  // namespace shearcell
