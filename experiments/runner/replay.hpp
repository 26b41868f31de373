// SPDX-License-Identifier: GPL-3.0-or-later
// Recomputes recorded states from an earlier kept state, to prove or to restore them.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "provenance/store.hpp"

namespace shearcell {

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
  std::optional<CheckpointRecord> from;  ///< nothing: from the beginning of the stage
  std::uint64_t steps = 0;               ///< number of recomputed steps
  std::optional<Divergence> divergence;
  bool interrupted = false;  ///< by a signal; there is no result and nothing was recorded
};

/// Every checkpoint that can be replayed, pruned ones included, in the order of runs and steps.
/// Checkpoints of another engine cannot.
std::vector<CheckpointRecord> replayable(const Store& store);

/// Why the checkpoints of a run cannot be recomputed bit for bit; nothing if they can.
std::optional<std::string> why_not_again(const Stage& run);

/// `count` of them without repetition, or all; the same for the same seed.
std::vector<CheckpointRecord> sample(std::vector<CheckpointRecord> records, std::size_t count,
                                     std::uint64_t seed);

/// A seed for sample() that changes with every new event of the log.
std::uint64_t seed_of(const Head& head);

/// Computes from the nearest earlier checkpoint that is kept, or the beginning of the stage, up to
/// the record's step, compares the state and all that is recorded with it (cycle, time, tilt,
/// observables), and records ReplayVerified or ReplayDiverged.
Replay verify_by_replay(Store& store, const CheckpointRecord& record, std::size_t threads = 1);

/// The same; also writes the file, so that a pruned, missing or damaged checkpoint is restored with
/// the same SHA-256. If the bytes differ, ReplayDiverged is recorded and no file is written.
Replay regenerate_checkpoint(Store& store, const CheckpointRecord& record, std::size_t threads = 1);

}  // namespace shearcell
