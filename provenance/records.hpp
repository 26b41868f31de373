// SPDX-License-Identifier: GPL-3.0-or-later
// Plain values that the store takes and returns.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/named.hpp"

namespace shearcell {

/// The place of a stage in an experiment. A stage that two experiments share has two places.
struct Place {
  std::string experiment = {};
  std::string scale = {};                           ///< "" if the manifest has no scales
  std::string variant = {};                         ///< the swept values: "fluid=still"
  nlohmann::json swept = nlohmann::json::object();  ///< swept key -> value
  std::uint64_t seed = 0;
  std::string manifest = {};  ///< SHA-256 of the manifest's text

  bool operator==(const Place&) const = default;
};

/// What an experiment asks of a stage.
struct Ask {
  std::uint64_t checkpoint_every = 1;          ///< cycles between checkpoints
  std::uint64_t target_cycles = 0;             ///< length
  nlohmann::json until = nullptr;              ///< measure that may end the stage earlier
  std::vector<double> checkpoint_phases = {};  ///< fractions of a cycle, for more checkpoints
  std::uint64_t ordinal = 0;                   ///< the event that put the stage in its place
};

/// A stage's place in an experiment, and what the experiment asks of the stage.
struct Membership {
  Place place = {};
  Ask ask = {};
  /// Whether the manifest is the last registered version among those that declared a stage at the
  /// scale.
  bool newest = true;

  static void fields(auto& m, auto field) {
    auto& [place, ask, newest] = m;
    field("experiment", place.experiment), field("scale", place.scale);
    field("variant", place.variant), field("labels", place.swept), field("seed", place.seed);
    field("manifest", place.manifest), field("checkpoint_every", ask.checkpoint_every);
    // Recorded only if they are stated.
    field("until", ask.until, true), field("checkpoint_phases", ask.checkpoint_phases, true);
  }
};

inline std::vector<Ask> asks_of(const std::vector<Membership>& memberships) {
  std::vector<Ask> asks;
  for (const Membership& m : memberships) asks.push_back(m.ask);
  return asks;
}

/// The name to show, also as JSON: "base" if the manifest has no scales. Events hold "".
inline std::string scale_name(const std::string& scale) {
  return scale.empty() ? "base" : scale;
}

/// Which checkpoints are listed: recorded ones; recorded and pruned ones; all, with rejected ones.
enum class Listed { recorded, and_pruned, all };

/// Ascending in the order in which a merge prefers a stage over its copy with as many steps.
enum class StageState { declared, running, interrupted, failed, completed };

template <>
inline constexpr auto kNames<StageState> = names_in_order<StageState>("declared", "running",
                                                                      "interrupted", "failed",
                                                                      "completed");

/// Whether the stage is completed or failed: nothing more is computed unless it is asked for again.
inline bool has_ended(StageState state) {
  return state == StageState::completed || state == StageState::failed;
}

/// A stage as a manifest states it or as its events describe it.
struct Stage {
  std::string id;                                      ///< 64 hex digits
  std::string parent;                                  ///< "" when there is none
  std::string kind;                                    ///< "prepare", "shear", ...
  nlohmann::json resolved = nlohmann::json::object();  ///< the record whose hash is the id
  /// `declared`: not started, or completed and then given a longer target. `running`: started and
  /// not ended; after a kill this remains until the run is resumed.
  StageState state = StageState::declared;
  std::uint64_t grains = 0;
  std::uint64_t target_cycles = 0;                ///< the largest declared target
  std::uint64_t attempts = 0;                     ///< number of starts and resumes
  double cycle = 0;                               ///< of the furthest checkpoint with a file
  std::uint64_t step = 0;                         ///< of that checkpoint
  std::string state_hash;                         ///< of that checkpoint; "" before the first
  double wall_seconds = 0;                        ///< sum over recorded efforts
  double particle_steps = 0;                      ///< sum over recorded efforts
  nlohmann::json ends = nlohmann::json::array();  ///< why each completion ended the run
  std::string error;                    ///< why it failed or was interrupted; "" otherwise
  std::string updated_at;               ///< time of its last event, UTC
  std::vector<Membership> memberships;  ///< in the order in which they were declared
};

/// What a user counts, lists and averages: a stage in one of its places. A stage of two experiments
/// is a run of each.
struct Run {
  Place place = {};
  Ask ask = {};
  Stage stage = {};       ///< the last one: shear or stiffening
  std::string name = {};  ///< of its variant, for people
  bool named = false;     ///< by a label of the manifest
  /// Of the newest version of its manifest, which did not later put another run in its place.
  bool newest = true;
};

/// Whether two stages with one id describe the same computation.
bool same_computation(const auto& a, const auto& b) {
  return a.parent == b.parent && a.kind == b.kind && a.resolved == b.resolved &&
         a.grains == b.grains;
}

/// Selects checkpoints to prune; all conditions must hold.
struct PruneChoice {
  std::vector<std::string> runs;  ///< ids; empty for all
  std::uint64_t keep_every = 0;   ///< K > 0 keeps cycles 0, K, 2K, ...
  /// Also the files from which runs would continue and stages started, of completed stages.
  bool last_too = false;
};

/// Work spent since the previous record of the same attempt.
struct Effort {
  double wall_seconds = 0;
  double particle_steps = 0;  ///< grains times time steps
  /// Processor time of the steps; none where it is not known, as in records of earlier versions.
  std::optional<double> core_seconds = {};
};

/// `rejected`: its file is damaged. `pruned`: its file was deleted to free space; the record stays.
enum class CheckpointState { recorded, rejected, pruned };
template <>
inline constexpr auto kNames<CheckpointState> = names_in_order<CheckpointState>("recorded",
                                                                                "rejected",
                                                                                "pruned");

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
  std::string name;           ///< "drag/desk/S2"
  std::uint64_t seq = 0;      ///< the event that recorded it
  std::string recorded_at;    ///< UTC
  nlohmann::json provenance;  ///< inputs and SHA-256 of the outputs
};

}  // namespace shearcell
