// SPDX-License-Identifier: GPL-3.0-or-later
// What the store is told about runs and what it tells back: plain values, no behaviour.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace shearcell {

/// One place of a run in an experiment. A run that two experiments share has two of them.
struct Membership {
  std::string experiment;
  std::string scale;
  std::string variant;                               ///< label of the swept values, as "drag=still"
  nlohmann::json labels = nlohmann::json::object();  ///< swept key -> value
  std::uint64_t seed = 0;
  std::string manifest;                ///< SHA-256 of the manifest's text
  std::uint64_t checkpoint_every = 1;  ///< cycles between checkpoints that it asks for
  std::uint64_t target_cycles = 0;     ///< what this experiment asks of the run; set by the store
  /// Measure that may end the run before that; null for none. Recorded, but not read back.
  nlohmann::json until = nullptr;
};

/// A run (one stage) as the expansion of a manifest gives it.
struct RunDeclaration {
  std::string id;      ///< 64 hex digits
  std::string parent;  ///< id of the stage whose last state this one starts from, or ""
  std::string kind;    ///< "prepare", "shear", ...
  nlohmann::json resolved = nlohmann::json::object();  ///< every parameter, in canonical form
  std::uint64_t grains = 0;
  std::uint64_t target_cycles = 0;
  Membership membership;
};

enum class RunState { declared, running, interrupted, failed, completed };

const char* name_of(RunState state);

/// A run as its events tell it.
struct RunRecord {
  std::string id;
  std::string parent;  ///< "" when there is none
  std::string kind;
  nlohmann::json resolved;
  /// `declared`: there is work and nobody has begun it, or a completed run was given a longer
  /// target. `running`: begun and not ended; after a kill it stays so until it is resumed.
  RunState state = RunState::declared;
  std::uint64_t grains = 0;
  std::uint64_t target_cycles = 0;      ///< the largest that was declared
  std::uint64_t attempts = 0;           ///< how often it was started or resumed
  double cycle = 0;                     ///< of the furthest checkpoint that was not rejected
  std::uint64_t step = 0;               ///< of that checkpoint
  std::string state_hash;               ///< of that checkpoint; "" before the first
  double wall_seconds = 0;              ///< sum over recorded efforts
  double particle_steps = 0;            ///< sum over recorded efforts
  std::string error;                    ///< why it failed or was interrupted; "" otherwise
  std::string updated_at;               ///< time of its last event, UTC
  std::vector<Membership> memberships;  ///< in the order in which they were declared
};

/// Which checkpoints need no file any more. Choices narrow each other down.
struct PruneChoice {
  std::vector<std::string> runs;  ///< ids; empty for all
  std::optional<RunState> state;  ///< only runs in this state
  std::uint64_t keep_every = 0;   ///< keep cycles 0, K, 2K, ...; 0 keeps none of them
};

/// Work spent since the previous record of the same attempt.
struct Effort {
  double wall_seconds = 0;
  double particle_steps = 0;  ///< grains times time steps
};

/// `pruned`: the file was removed to free its bytes, and the record stays.
enum class CheckpointState { recorded, rejected, pruned };

const char* name_of(CheckpointState state);

struct CheckpointRecord {
  std::string run;
  std::uint64_t step = 0;
  double cycle = 0;
  double time_s = 0;
  std::string file;        ///< relative to the store's folder
  std::uint64_t size = 0;  ///< [bytes]
  std::string sha256;
  std::string state_hash;
  std::map<std::string, double> observables;
  CheckpointState state = CheckpointState::recorded;
  std::uint64_t seq = 0;  ///< the event that recorded it
};

struct FigureRecord {
  std::string name;
  std::uint64_t seq = 0;      ///< the event that recorded it
  std::string recorded_at;    ///< UTC
  nlohmann::json provenance;  ///< inputs and SHA-256 of the outputs, as they were recorded
};

}  // namespace shearcell
