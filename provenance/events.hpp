// SPDX-License-Identifier: GPL-3.0-or-later
// The payloads of the events, one struct each, and their JSON. provenance/README.md lists the
// events with the streams that hold them.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "provenance/event_log.hpp"
#include "provenance/records.hpp"

namespace shearcell::events {

// `fields` names each member once, for reading and for writing. All members are required in a
// payload; optional ones may be null.

struct ManifestRegistered {
  static constexpr std::string_view kType = "ManifestRegistered";
  std::string sha256, path, text;
  nlohmann::json info;
  static void fields(auto& e, auto field) {
    field("sha256", e.sha256), field("path", e.path), field("text", e.text);
    field("info", e.info);
  }
};

struct RunDeclared {
  static constexpr std::string_view kType = "RunDeclared";
  std::string parent, kind;
  nlohmann::json resolved;
  std::uint64_t grains = 0, target_cycles = 0;
  Membership membership;  ///< without its target_cycles
  static void fields(auto& e, auto field) {
    field("parent", e.parent), field("kind", e.kind), field("resolved", e.resolved);
    field("grains", e.grains), field("target_cycles", e.target_cycles);
    field("membership", e.membership);
  }
};

struct RunStarted {
  static constexpr std::string_view kType = "RunStarted";
  std::uint64_t attempt = 0;
  nlohmann::json host, process;
  std::optional<std::string> parent_checkpoint;  ///< SHA-256
  static void fields(auto& e, auto field) {
    field("attempt", e.attempt), field("host", e.host), field("process", e.process);
    field("parent_checkpoint", e.parent_checkpoint);
  }
};

struct StateReached {
  std::string sha256;  ///< of the checkpoint
  std::uint64_t step = 0;
  double cycle = 0;
  static void fields(auto& e, auto field) {
    field("sha256", e.sha256), field("step", e.step), field("cycle", e.cycle);
  }
};

struct RunResumed {
  static constexpr std::string_view kType = "RunResumed";
  std::uint64_t attempt = 0;
  nlohmann::json host, process;
  StateReached from;
  static void fields(auto& e, auto field) {
    field("attempt", e.attempt), field("host", e.host), field("process", e.process);
    field("from", e.from);
  }
};

struct CheckpointRecorded {
  static constexpr std::string_view kType = "CheckpointRecorded";
  std::uint64_t step = 0;
  double cycle = 0, time_s = 0;
  std::string file;
  std::uint64_t size = 0;
  std::string sha256, state_hash;
  nlohmann::json observables;
  double wall_seconds = 0, particle_steps = 0;
  static void fields(auto& e, auto field) {
    field("step", e.step), field("cycle", e.cycle), field("time_s", e.time_s);
    field("file", e.file), field("size", e.size), field("sha256", e.sha256);
    field("state_hash", e.state_hash), field("observables", e.observables);
    field("wall_seconds", e.wall_seconds), field("particle_steps", e.particle_steps);
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

/// A checkpoint whose file was deleted or written again.
struct CheckpointFile {
  std::string sha256, file, state_hash;
  std::uint64_t step = 0, size = 0;
  double cycle = 0;
  explicit CheckpointFile(const CheckpointRecord& r = {})
      : sha256(r.sha256),
        file(r.file),
        state_hash(r.state_hash),
        step(r.step),
        size(r.size),
        cycle(r.cycle) {}
  static void fields(auto& e, auto field) {
    field("sha256", e.sha256), field("step", e.step), field("cycle", e.cycle);
    field("file", e.file), field("size", e.size), field("state_hash", e.state_hash);
  }
};

struct CheckpointPruned : CheckpointFile {
  static constexpr std::string_view kType = "CheckpointPruned";
  using CheckpointFile::CheckpointFile;
};

struct CheckpointRegenerated : CheckpointFile {
  static constexpr std::string_view kType = "CheckpointRegenerated";
  using CheckpointFile::CheckpointFile;
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

// The store keeps these payloads as their writers compose them.
struct ReplayVerified {
  static constexpr std::string_view kType = "ReplayVerified";
  nlohmann::json facts;
};
struct ReplayDiverged {
  static constexpr std::string_view kType = "ReplayDiverged";
  nlohmann::json facts;
};
struct FigureGenerated {
  static constexpr std::string_view kType = "FigureGenerated";
  nlohmann::json facts;
};
struct CampaignSubmitted {
  static constexpr std::string_view kType = "CampaignSubmitted";
  nlohmann::json facts;
};
struct JobQueued {
  static constexpr std::string_view kType = "JobQueued";
  nlohmann::json facts;
};

/// An event of a type that this program does not know.
struct Unknown {};

using Any =
    std::variant<Unknown, ManifestRegistered, RunDeclared, RunStarted, RunResumed,
                 CheckpointRecorded, CheckpointRejected, RunInterrupted, RunFailed, RunCompleted,
                 CheckpointPruned, CheckpointRegenerated, ReplayVerified, ReplayDiverged,
                 FigureGenerated, CampaignSubmitted, JobQueued, StoreMerged>;

/// Throws StoreDamaged, naming the event, when its payload lacks what its type requires.
Any decode(const Event& event);
NewEvent encode(const Any& event);

/// The layout in which payloads of this type are written: 1 for a type that never changed.
std::uint64_t newest_schema(std::string_view type);
/// Converts a payload of layout `schema` to the newest layout of its type. Stored events are never
/// rewritten. Throws StoreDamaged when the layout is newer than this program knows.
nlohmann::json upcast(std::string_view type, std::uint64_t schema, nlohmann::json payload);

inline bool begins_attempt(const Event& event) {
  return event.type == RunStarted::kType || event.type == RunResumed::kType;
}
inline bool ends_attempt(const Event& event) {
  return event.type == RunInterrupted::kType || event.type == RunFailed::kType ||
         event.type == RunCompleted::kType;
}

/// Selects the handler by the type of the event, for std::visit.
template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;  // clang 14 does not deduce it

}  // namespace shearcell::events
