// SPDX-License-Identifier: GPL-3.0-or-later
// The append-only log store.sqlite: events in streams. A chain of hashes reveals any later change.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// Version of the table layout, stored as user_version.
inline constexpr std::int64_t kSchemaVersion = 3;

/// Opens the log, creates its tables when it is new or empty, and migrates an older schema without
/// changing events. With Access::read, an older file is unchanged; tables of the new schema are
/// built in memory. Any file, even with Access::read, is opened for writing if possible, so that
/// SQLite can roll back the transaction of a killed program. Throws StoreDamaged when the file is
/// not a store or has a newer schema, NotFound when a killed program left an empty log and `access`
/// is not Access::create, and MachineError when the user has no permission to write and `access`
/// requires it.
sqlite::Database open_database(const std::filesystem::path& file, Access access);

/// For a log that is missing or empty: throws StoreDamaged if its folder has checkpoints or
/// measures, because the log was lost. `state` is the state of the log in the message.
void require_no_results(const std::filesystem::path& log, const std::string& state);

/// One row of the log.
struct Event {
  std::uint64_t seq = 0;      ///< 1, 2, 3, ... in the whole log
  std::string stream;         ///< such as "run/<id>", "manifest/<sha256>", "figure/<name>"
  std::uint64_t version = 0;  ///< 1, 2, 3, ... in the stream
  std::string type;
  std::uint64_t schema = 1;  ///< version of the payload's layout
  std::string recorded_at;   ///< UTC, ISO 8601 with milliseconds
  std::string payload;       ///< JSON text, kept byte for byte because it is hashed
  std::string prev_hash;
  std::string hash;

  /// The payload in the newest layout of its type (events.hpp). Throws StoreDamaged when it is not
  /// a JSON object or its layout is unknown.
  nlohmann::json body() const;
};

std::string run_stream(std::string_view run);  ///< "run/<id>"
/// The id of the event's run; nothing if the stream does not belong to a run.
std::optional<std::string> run_of(const Event& event);

/// A time [ms since 1970] as ISO 8601 with milliseconds, UTC: "2026-11-22T09:55:45.123Z".
std::string utc_text(std::int64_t ms);

struct NewEvent {
  std::string type;
  nlohmann::json payload;       ///< in the newest layout of its type
  std::string not_before = {};  ///< recorded_at is this time or later
};

/// Identifies the content of a log: equal heads mean equal logs.
struct Head {
  std::uint64_t seq = 0;  ///< 0 when the log is empty
  std::string hash;       ///< 64 zeros when the log is empty
};

/// The first event at which the chain is broken.
struct ChainFault {
  std::uint64_t seq = 0;
  std::string message;
};

/// The hash of an event: SHA-256 over the text "shearcell event 1", prev_hash and the other fields,
/// each written as a netstring ("<length in bytes>:<bytes>,"). Numbers are written in decimal.
std::string event_hash(const Event& event);

/// Not thread-safe; the database must outlive the log.
class EventLog {
 public:
  explicit EventLog(sqlite::Database& database) : database_(database) {}

  /// Appends an event to a stream, in the newest layout of its type. The parameter `lock` proves
  /// that the caller holds the write lock, so that no seq or version is assigned twice.
  Event append(const sqlite::WriteTransaction& lock, std::string_view stream,
               const NewEvent& event);

  /// Copies an event of another log to the end of this log. Stream, type, schema, recorded_at and
  /// payload stay the same; seq, version and hashes are new.
  Event append_copy(const sqlite::WriteTransaction& lock, Event event);

  /// Number of events in the stream.
  std::uint64_t version(std::string_view stream) const;
  Head head() const;
  /// Hash of the event with this seq: 64 zeros for seq 0, "" when there is no such event.
  std::string hash_at(std::uint64_t seq) const;
  /// Events in order. An empty `stream` means all streams, and an empty `type` means all types.
  std::vector<Event> events(std::string_view stream = "", std::string_view type = "") const;
  /// Calls visit(event) for all events from `from` on in order, without loading all of them into
  /// memory.
  void for_each(const std::function<void(const Event&)>& visit, std::uint64_t from = 1) const;
  /// Recomputes every hash from event `from` on. Returns the first fault, or nothing when the chain
  /// is valid.
  std::optional<ChainFault> verify_chain(std::uint64_t from = 1) const;

 private:
  sqlite::Database& database_;
};

}  // namespace shearcell
