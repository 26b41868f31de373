// SPDX-License-Identifier: GPL-3.0-or-later
// Computes one stage from its record in the store and records the result; computes a recorded state
// again, to verify it or to restore its file.
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

/// Threads and processes of one stage.
struct Parallel {
  std::size_t threads = 1;  ///< of our own simulation; results do not depend on it
  std::size_t ranks = 1;    ///< processes of LAMMPS, under mpirun when more than one
};

/// How a stage ended in this process. `already`: nothing was left to compute. `lost`: another
/// program holds the stage or took its lease, completed it or recorded a later state.
enum class StageOutcome : std::uint8_t { completed, already, interrupted, failed, lost };

struct StageOptions {
  Parallel parallel = {};
  bool restores = true;  ///< whether it recomputes files of pruned states that it needs
  std::function<void(const std::string&)> damaged = {};  ///< called for each skipped checkpoint
  std::function<void()> begun = {};                      ///< called when an attempt is recorded
  /// Called when the stage continues a state that this program would compute with other bits.
  std::function<void(const std::string&)> continuing = {};
  /// Called before a pruned state that the stage needs is recomputed.
  std::function<void(const std::string&)> restoring = {};
  /// Called a few times a second with the progress: where the stage is, its rate, the time left.
  std::function<void(const std::string&)> report = {};
};

/// Computes the stage `id` until its target, then its missing checkpoints. Starts from the newest
/// valid checkpoint; without one, from the last state of the parent, or a new filling. If the file
/// of that state was pruned, it is recomputed first, as by regenerate_checkpoint(). Between
/// chunks of steps of about 50 ms it checks stop_requested() and whether the store still holds the
/// run. Throws, before an attempt is recorded: StoreDamaged when the parent is not completed, its
/// last state cannot be read, or the recorded parameters do not give the id; NotFound when the
/// state was never recorded, FilePruned when it was pruned and cannot be recomputed; GeometryError
/// for a cell that cannot be filled; TooLittleMemory; ProgramError when the stage's engine is not
/// installed. A stage that is interrupted while its cell is filled records nothing.
StageOutcome run_stage(Store& store, const std::string& id, const StageOptions& options);

/// Whether the stage is done and its last state can be read.
bool is_done(const Store& store, const Stage& stage);

/// The checkpoint, recorded or pruned, at `start_cycle` of the parent, if the parent is a shear:
/// the state with which a shear of these parameters begins. Nothing if it was never recorded.
std::optional<CheckpointRecord> recorded_start(const Store& store, const Stage& stage,
                                               const Parameters& parameters);

/// Where a recomputed state differs from the recorded one.
struct Divergence {
  std::uint64_t same_step = 0;   ///< last step known to be the same: where the replay began
  std::uint64_t first_step = 0;  ///< first step known to differ
  /// "position", "velocity", "wall_height", "wall_velocity"; if the states are equal: "cycle",
  /// "time_s", "theta" or the name of an observable; if these are equal too: "file"; "" if unknown.
  std::string field;
  std::int64_t grain = -1;
  std::uint64_t ulp = 0;  ///< largest distance in the field [units in the last place]
  std::string message;
};

nlohmann::json to_json(const Divergence& divergence);

struct Replay {
  CheckpointRecord record;
  std::optional<CheckpointRecord> from = {};  ///< nothing: from the beginning of the stage
  std::uint64_t steps = 0;                    ///< number of recomputed steps
  std::optional<Divergence> divergence = {};
  bool interrupted = false;  ///< by a signal; there is no result and nothing was recorded
};

/// Why this program cannot recompute the checkpoint bit for bit; nothing if it can. `known` holds
/// what was read of the log for other checkpoints.
std::optional<std::string> why_not_again(const Store& store, const CheckpointRecord& record,
                                         RunLineages& known);

/// Computes from the nearest earlier checkpoint that is kept, or from the beginning of the stage,
/// up to the record's step. Compares the state and all that is recorded with it (cycle, time, tilt,
/// observables), and records ReplayVerified or ReplayDiverged. Throws FilePruned if the state that
/// the stage begins with was pruned and is needed.
Replay verify_by_replay(Store& store, const CheckpointRecord& record, std::size_t threads = 1);

/// verify_by_replay() that also writes the file, so that a pruned, missing or damaged checkpoint is
/// restored with the same SHA-256. The state that the stage begins with is restored too, if it was
/// pruned and is needed. If the bytes differ, ReplayDiverged is recorded and no file is written.
Replay regenerate_checkpoint(Store& store, const CheckpointRecord& record, std::size_t threads = 1);

}  // namespace shearcell
