// SPDX-License-Identifier: GPL-3.0-or-later
// Plain structs that the functions of the store accept and return.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/named.hpp"

namespace shearcell {

/// Experiment, scale, variant and seed of a stage. A stage of two experiments has two Places.
struct Place {
  std::string experiment = {};
  std::string scale = {};                           ///< "" if the manifest has no scales
  std::string variant = {};                         ///< the swept values: "fluid=still"
  nlohmann::json swept = nlohmann::json::object();  ///< swept key -> value
  std::uint64_t seed = 0;
  std::string manifest = {};  ///< SHA-256 of the manifest's text

  bool operator==(const Place&) const = default;
};

/// What an experiment requests: how far to compute a stage, and which checkpoints to record.
struct Ask {
  std::uint64_t checkpoint_every = 1;          ///< cycles between checkpoints
  std::uint64_t target_cycles = 0;             ///< number of cycles to compute
  nlohmann::json until = nullptr;              ///< may end the stage before target_cycles
  std::vector<double> checkpoint_phases = {};  ///< extra checkpoints: fractions of a cycle
  std::uint64_t ordinal = 0;                   ///< seq of the event that declared this request
};

/// Where an experiment uses a stage (scale, variant, seed), and what the experiment requests.
struct Membership {
  Place place = {};
  Ask ask = {};
  /// False if a newer manifest declares stages of the same experiment and scale.
  bool newest = true;

  static void fields(auto& m, auto field) {
    auto& [place, ask, newest] = m;
    field("experiment", place.experiment), field("scale", place.scale);
    field("variant", place.variant), field("labels", place.swept), field("seed", place.seed);
    field("manifest", place.manifest), field("checkpoint_every", ask.checkpoint_every);
    // Written only if the manifest sets them.
    field("until", ask.until, true), field("checkpoint_phases", ask.checkpoint_phases, true);
  }
};

inline std::vector<Ask> asks_of(const std::vector<Membership>& memberships) {
  std::vector<Ask> asks;
  for (const Membership& m : memberships) asks.push_back(m.ask);
  return asks;
}

/// The name of a scale in text and JSON. If the manifest has no scales, this is "base"; events
/// record "" instead.
inline std::string scale_name(const std::string& scale) {
  return scale.empty() ? "base" : scale;
}

/// " at scale desk", for messages. Empty if the manifest has no scales.
inline std::string at_scale(const std::string& scale) {
  return scale.empty() ? "" : " at scale " + scale;
}

/// The name of a variant in sentences: "no sweep" instead of "base".
inline std::string variant_in_words(const std::string& variant) {
  return variant == "base" ? "no sweep" : variant;
}

/// Which checkpoints to list. `and_pruned`: also pruned ones. `all`: also pruned and rejected ones.
enum class Listed { recorded, and_pruned, all };

/// If two stores hold a stage at the same step, a merge keeps the state that is later in this list.
enum class StageState { declared, running, interrupted, failed, completed };

template <>
inline constexpr auto kNames<StageState> = names_in_order<StageState>("declared", "running",
                                                                      "interrupted", "failed",
                                                                      "completed");

/// Whether the stage is completed or failed. Nothing more is computed unless a user asks for it.
inline bool has_ended(StageState state) {
  return state == StageState::completed || state == StageState::failed;
}

/// A stage as a manifest defines it or as its events describe it.
struct Stage {
  std::string id;                                      ///< 64 hex digits
  std::string parent;                                  ///< id of the preceding stage; "" if none
  std::string kind;                                    ///< "prepare", "shear", ...
  nlohmann::json resolved = nlohmann::json::object();  ///< parameters; the id is their hash
  /// `declared`: not started, or completed and later found incomplete (a larger target, or a
  /// rejected last checkpoint). `running`: started and not ended; after a kill the stage stays
  /// `running` until it is resumed.
  StageState state = StageState::declared;
  std::uint64_t grains = 0;
  std::uint64_t target_cycles = 0;  ///< the largest declared target
  std::uint64_t attempts = 0;       ///< number of starts and resumes
  double cycle = 0;                 ///< cycle of the last checkpoint
  std::uint64_t step = 0;           ///< step of the last checkpoint
  std::string state_hash;           ///< of the last checkpoint, or ""
  double wall_seconds = 0;          ///< sum over all checkpoints
  double particle_steps = 0;        ///< sum over all checkpoints
  /// Why the stage ended: one entry for each time that it was completed.
  nlohmann::json ends = nlohmann::json::array();
  std::string error;                    ///< why the stage failed or was interrupted, or ""
  std::string updated_at;               ///< time of the stage's last event, UTC
  std::vector<Membership> memberships;  ///< in the order in which they were declared
};

/// One run as users count it: an experiment, scale, variant and seed, with the last stage computed
/// for this combination. A stage that two experiments share belongs to two runs.
struct Run {
  Place place = {};
  Ask ask = {};
  Stage stage = {};       ///< the last stage: shear or stiffening
  std::string name = {};  ///< name of the variant, for display
  bool named = false;     ///< whether `name` is a label from the manifest
  /// False if the manifest has a newer version, or if a later run was declared for `place`.
  bool newest = true;
};

/// Whether two stages that have the same id describe the same computation.
bool same_computation(const auto& a, const auto& b) {
  return a.parent == b.parent && a.kind == b.kind && a.resolved == b.resolved &&
         a.grains == b.grains;
}

/// Selects checkpoints to prune. A checkpoint must meet all conditions.
struct PruneChoice {
  std::vector<std::string> runs;  ///< run ids; empty for all runs
  std::uint64_t keep_every = 0;   ///< K > 0 keeps cycles 0, K, 2K, ...
  /// In completed stages, also prune the last checkpoint (the stage then cannot be continued) and
  /// the checkpoints from which other stages started.
  bool last_too = false;
};

/// Work of an attempt since its previous checkpoint.
struct Effort {
  double wall_seconds = 0;
  double particle_steps = 0;  ///< grains times time steps
  /// Processor time of the steps; nothing if unknown, for example in events of earlier versions.
  std::optional<double> core_seconds = {};
};

/// `rejected`: the file is damaged. `pruned`: the file was deleted to free space.
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
  std::uint64_t seq = 0;  ///< seq of the event that recorded the checkpoint
};

struct FigureRecord {
  std::string name;           ///< "drag/desk/S2"
  std::uint64_t seq = 0;      ///< seq of the event that recorded the figure
  std::string recorded_at;    ///< UTC
  nlohmann::json provenance;  ///< inputs and SHA-256 of the outputs
};

}  // namespace shearcell
