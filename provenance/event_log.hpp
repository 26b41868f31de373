// SPDX-License-Identifier: GPL-3.0-or-later
// The append-only log: events in streams, chained by SHA-256 so that any later change shows.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// One row of the log.
struct Event {
  std::uint64_t seq = 0;      ///< 1, 2, 3, ... over the whole log
  std::string stream;         ///< "run/<id>", "manifest/<sha256>", "figure/<name>"
  std::uint64_t version = 0;  ///< 1, 2, 3, ... within the stream
  std::string type;
  std::uint64_t schema = 1;  ///< version of the payload's layout
  std::string recorded_at;   ///< UTC, ISO 8601 with milliseconds
  std::string payload;       ///< JSON text, kept byte for byte because it is hashed
  std::string prev_hash;
  std::string hash;

  /// The payload parsed, in the newest layout of its type (upcast.hpp). Throws StoreDamaged when it
  /// is not a JSON object or newer than this program.
  nlohmann::json body() const;
};

struct NewEvent {
  std::string type;
  nlohmann::json payload;  ///< in the newest layout of its type
};

/// Names one state of the log: the same head means the same log, event by event.
struct Head {
  std::uint64_t seq = 0;  ///< 0 when the log is empty
  std::string hash;       ///< 64 zeros when the log is empty
};

/// The first event at which the chain does not hold.
struct ChainFault {
  std::uint64_t seq = 0;
  /// "seq", "version", "prev_hash", "hash", or "content": one of stream, type, schema,
  /// recorded_at and payload, which the chain covers together.
  std::string field;
  std::string message;
};

/// The hash of an event: SHA-256 over the domain tag, prev_hash and the other fields, each written
/// as a netstring ("<length in bytes>:<bytes>,"), numbers in decimal. See provenance/README.md.
std::string event_hash(const Event& event);

/// Not thread-safe; the database must outlive the log.
class EventLog {
 public:
  explicit EventLog(sqlite::Database& database);

  /// Appends all events to one stream, or none. Throws ConcurrencyConflict when the stream's
  /// version is not `expected_version` (0 for a stream that does not exist yet). The transaction
  /// proves that the write lock is held, so that seq and version cannot be given twice.
  std::vector<Event> append(const sqlite::WriteTransaction& lock, std::string_view stream,
                            std::uint64_t expected_version, std::span<const NewEvent> events);

  /// Appends an event of another log at the end of its stream, as it stands there: type, layout,
  /// time and payload. Its place in the chain is new.
  Event append_copy(const sqlite::WriteTransaction& lock, const Event& original);

  /// Number of events in the stream.
  std::uint64_t version(std::string_view stream) const;
  Head head() const;
  /// Hash of the event with this number: 64 zeros for 0, "" when there is none.
  std::string hash_at(std::uint64_t seq) const;
  /// Events of one stream after a version, or of the whole log ("") in order of seq.
  std::vector<Event> events(std::string_view stream = "", std::uint64_t after_version = 0) const;
  /// The same, one by one, for logs that are better not held in memory.
  void for_each(const std::function<void(const Event&)>& visit) const;
  /// Recomputes every hash. Nothing is returned when the chain holds.
  std::optional<ChainFault> verify_chain() const;

 private:
  sqlite::Database& database_;
};

}  // namespace shearcell
