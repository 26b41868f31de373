// SPDX-License-Identifier: GPL-3.0-or-later
// Where the checkpoints of a run came from: which attempt made each, on what host, with what build,
// and from which state it began. Read from the events alone.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "provenance/store.hpp"

namespace shearcell {

/// `lost`: no event says how it ended, and a later attempt went on (a kill, a power cut).
enum class AttemptOutcome { running, completed, interrupted, failed, lost };

const char* name_of(AttemptOutcome outcome);

/// One time that a program worked on a run, from its start to its end.
struct Attempt {
  std::uint64_t seq = 0;   ///< the event that began it
  std::string started_at;  ///< UTC
  std::string ended_at;    ///< UTC; "" when no event says so
  AttemptOutcome outcome = AttemptOutcome::running;
  std::string why;  ///< it failed or was interrupted; "" otherwise
  /// Host, build and libraries as they were recorded; an object, empty when there were none.
  nlohmann::json host = nlohmann::json::object();
  std::string from_run;                  ///< whose state it began with; "" for a fresh filling
  std::string from_checkpoint;           ///< SHA-256 of it; "" for a fresh filling
  std::vector<std::string> checkpoints;  ///< SHA-256 of those that it recorded, in order
};

/// One checkpoint with what became of it.
struct CheckpointHistory {
  CheckpointRecord record;
  std::string recorded_at;  ///< UTC
  /// Place in RunLineage::attempts of the one that recorded it, the last one when several did.
  std::optional<std::size_t> attempt;
  bool rejected = false;
  bool pruned = false;  ///< its bytes were given up on purpose
};

struct RunLineage {
  RunRecord run;
  std::vector<Attempt> attempts;               ///< in the order of the log; people count from 1
  std::vector<CheckpointHistory> checkpoints;  ///< in the order in which they were first recorded

  const CheckpointHistory* find(std::string_view sha256) const;
};

/// The run and the stages before it, the first one first. Throws NotFound for an unknown run and
/// StoreDamaged, naming the event, for one that does not hold what its type must.
std::vector<RunLineage> run_lineage(const Store& store, const std::string& id);

struct ManifestText {
  std::string sha256;
  std::string path;           ///< as it was given when it was registered; only a name
  std::string text;           ///< whose SHA-256 was checked
  std::string registered_at;  ///< UTC
};

/// The manifest as the store keeps it; nothing when it was never registered. Throws StoreDamaged
/// when the kept text has another SHA-256.
std::optional<ManifestText> find_manifest(const Store& store, const std::string& sha256);

}  // namespace shearcell
