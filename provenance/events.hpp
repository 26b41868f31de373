// SPDX-License-Identifier: GPL-3.0-or-later
// One struct for the payload of each event that this program reads, and its form in JSON.
// provenance/README.md lists all events with the streams that hold them.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "provenance/derived.hpp"
#include "provenance/event_log.hpp"
#include "provenance/records.hpp"

namespace shearcell::events {

// `fields` calls `field` for each member of a payload, for reading and for writing. If the third
// argument of `field` is `true`, the member may be missing, and is written only if it is not
// empty. All other members are required. std::optional members may be null.

/// Base of the events that hold the text of a file.
struct TextRegistered {
  std::string sha256, path, text;  ///< `path` as the user gave it, for display only
  static void fields(auto& e, auto field) {
    field("sha256", e.sha256), field("path", e.path), field("text", e.text);
  }
};

struct ManifestRegistered : TextRegistered {
  static constexpr std::string_view kType = "ManifestRegistered";
  nlohmann::json info;
  static void fields(auto& e, auto field) {
    TextRegistered::fields(e, field);
    field("info", e.info);
  }
};

/// A file of grain positions that was registered as the initial packing of runs.
struct PackingRegistered : TextRegistered {
  static constexpr std::string_view kType = "PackingRegistered";
};

struct RunDeclared {
  static constexpr std::string_view kType = "RunDeclared";
  Stage stage;  ///< only the members in `fields` are stored
  Membership membership;
  static void fields(auto& e, auto field) {
    field("parent", e.stage.parent), field("kind", e.stage.kind),
        field("resolved", e.stage.resolved);
    field("grains", e.stage.grains), field("target_cycles", e.membership.ask.target_cycles);
    field("membership", e.membership);
  }
};

/// Base of the events that begin an attempt.
struct AttemptBegun {
  std::uint64_t attempt = 0;
  nlohmann::json host, process;
  std::optional<std::uint64_t> bits_version = {};  ///< absent in events of earlier versions
  static void fields(auto& e, auto field) {
    field("attempt", e.attempt), field("host", e.host), field("process", e.process);
    field("bits_version", e.bits_version, true);
  }
};

struct RunStarted : AttemptBegun {
  static constexpr std::string_view kType = "RunStarted";
  std::optional<std::string> parent_checkpoint = {};  ///< SHA-256 of the initial state
  static void fields(auto& e, auto field) {
    AttemptBegun::fields(e, field);
    field("parent_checkpoint", e.parent_checkpoint);
  }
};

struct StateReached {
  std::string sha256;  ///< SHA-256 of the checkpoint file
  std::uint64_t step = 0;
  double cycle = 0;
  static void fields(auto& e, auto field) {
    field("sha256", e.sha256), field("step", e.step), field("cycle", e.cycle);
  }
};

struct RunResumed : AttemptBegun {
  static constexpr std::string_view kType = "RunResumed";
  StateReached from;
  static void fields(auto& e, auto field) {
    AttemptBegun::fields(e, field);
    field("from", e.from);
  }
};

/// Base of the events that describe a checkpoint file.
struct CheckpointFile {
  CheckpointRecord checkpoint;
  static void fields(auto& e, auto field) {
    auto& c = e.checkpoint;
    field("sha256", c.sha256), field("step", c.step), field("cycle", c.cycle);
    field("file", c.file), field("size", c.size), field("state_hash", c.state_hash);
  }
};

struct CheckpointPruned : CheckpointFile {
  static constexpr std::string_view kType = "CheckpointPruned";
  Digests measures = {};  ///< digests of cached measures; empty in older events
  static void fields(auto& e, auto field) {
    CheckpointFile::fields(e, field);
    field("measures", e.measures, true);
  }
};

struct CheckpointRegenerated : CheckpointFile {
  static constexpr std::string_view kType = "CheckpointRegenerated";
};

struct CheckpointRecorded : CheckpointFile {
  static constexpr std::string_view kType = "CheckpointRecorded";
  Effort effort;
  static void fields(auto& e, auto field) {
    CheckpointFile::fields(e, field);
    field("time_s", e.checkpoint.time_s), field("observables", e.checkpoint.observables);
    field("wall_seconds", e.effort.wall_seconds), field("particle_steps", e.effort.particle_steps);
    field("core_seconds", e.effort.core_seconds, true);
  }
};

struct CheckpointRejected {
  static constexpr std::string_view kType = "CheckpointRejected";
  std::string sha256;
  std::uint64_t step = 0;
  std::string why;
  static void fields(auto& e, auto field) {
    field("sha256", e.sha256), field("step", e.step), field("why", e.why);
  }
};

struct RunInterrupted {
  static constexpr std::string_view kType = "RunInterrupted";
  std::string why;
  static void fields(auto& e, auto field) { field("why", e.why); }
};

struct RunFailed {
  static constexpr std::string_view kType = "RunFailed";
  std::string why;
  nlohmann::json numbers;
  static void fields(auto& e, auto field) { field("why", e.why), field("numbers", e.numbers); }
};

struct RunCompleted {
  static constexpr std::string_view kType = "RunCompleted";
  nlohmann::json summary;
  std::optional<std::uint64_t> target_cycles;
  static void fields(auto& e, auto field) {
    field("summary", e.summary), field("target_cycles", e.target_cycles);
  }
};

struct StoreMerged {
  static constexpr std::string_view kType = "StoreMerged";
  std::string source;
  nlohmann::json head;
  std::uint64_t events = 0, checkpoints = 0;
  static void fields(auto& e, auto field) {
    field("source", e.source), field("head", e.head), field("events", e.events);
    field("checkpoints", e.checkpoints);
  }
};

/// An event that has no struct above: FigureGenerated, for example, or an event of unknown type.
struct Other {
  static constexpr std::string_view kType = "Other";
  static void fields(auto&, auto) {}
};

using Any =
    std::variant<Other, ManifestRegistered, PackingRegistered, RunDeclared, RunStarted, RunResumed,
                 CheckpointRecorded, CheckpointRejected, RunInterrupted, RunFailed, RunCompleted,
                 CheckpointPruned, CheckpointRegenerated, StoreMerged>;

/// Throws StoreDamaged, which names the event, when a required member of the payload is missing.
Any decode(const Event& event);
NewEvent encode(const Any& event);

/// The newest payload layout of this event type; 1 if the layout never changed.
std::uint64_t newest_schema(std::string_view type);

inline constexpr const char* kFigureGenerated = "FigureGenerated";

inline bool begins_attempt(const Event& event) {
  return event.type == RunStarted::kType || event.type == RunResumed::kType;
}
inline bool ends_attempt(const Event& event) {
  return event.type == RunInterrupted::kType || event.type == RunFailed::kType ||
         event.type == RunCompleted::kType;
}

}  // namespace shearcell::events
