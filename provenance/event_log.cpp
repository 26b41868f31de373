// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/event_log.hpp"

#include <fmt/format.h>

#include <map>

#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

constexpr std::string_view kColumns =
    "SELECT seq, stream, version, type, schema, recorded_at, payload, prev_hash, hash FROM events ";

std::string zeros() {
  return std::string(64, '0');
}

Event read_event(const sqlite::Statement& row) {
  Event e;
  row.get(e.seq, e.stream, e.version, e.type, e.schema, e.recorded_at, e.payload, e.prev_hash,
          e.hash);
  return e;
}

void insert_event(const sqlite::Database& database, const Event& e) {
  sqlite::Statement(database,
                    "INSERT INTO events(seq, stream, version, type, schema, recorded_at, payload, "
                    "prev_hash, hash) VALUES(?,?,?,?,?,?,?,?,?)",
                    e.seq, e.stream, e.version, e.type, e.schema, e.recorded_at, e.payload,
                    e.prev_hash, e.hash)
      .run();
}

/// The field whose value in the neighbouring events makes the hash valid again.
std::string changed_field(const Event& event, const std::string& prev_hash, std::uint64_t version,
                          const std::optional<Event>& next) {
  Event repaired = event;
  repaired.prev_hash = prev_hash;
  if (event_hash(repaired) == event.hash) return "prev_hash";
  repaired = event;
  repaired.version = version;
  if (event_hash(repaired) == event.hash) return "version";
  if (next && next->prev_hash == event_hash(event)) return "hash";
  return "content";
}

}  // namespace

std::string event_hash(const Event& event) {
  Sha256 sha;
  sha.add_field("shearcell event 1").add_field(event.prev_hash);
  sha.add_field(std::to_string(event.seq)).add_field(event.stream);
  sha.add_field(std::to_string(event.version)).add_field(event.type);
  sha.add_field(std::to_string(event.schema)).add_field(event.recorded_at);
  return sha.add_field(event.payload).hex();
}

EventLog::EventLog(sqlite::Database& database) : database_(database) {}

std::vector<Event> EventLog::append(const sqlite::WriteTransaction&, std::string_view stream,
                                    std::uint64_t expected_version,
                                    std::span<const NewEvent> events) {
  const std::uint64_t found = version(stream);
  if (found != expected_version) {
    throw ConcurrencyConflict(fmt::format(
        "{}: stream {} has version {} instead of {}: another process wrote to it; read it "
        "again",
        database_.name(), stream, found, expected_version));
  }
  Head last = head();
  std::vector<Event> appended;
  for (const NewEvent& fresh : events) {
    Event event;
    event.seq = ++last.seq;
    event.stream = stream;
    event.version = ++expected_version;
    event.type = fresh.type;
    event.schema = events::newest_schema(fresh.type);
    event.recorded_at = utc_now();
    // Bytes that are not UTF-8, as in a path, become U+FFFD.
    event.payload = fresh.payload.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    event.prev_hash = last.hash;
    event.hash = last.hash = event_hash(event);
    insert_event(database_, event);
    appended.push_back(std::move(event));
  }
  return appended;
}

Event EventLog::append_copy(const sqlite::WriteTransaction&, const Event& original) {
  const Head last = head();
  Event event = original;
  event.seq = last.seq + 1;
  event.version = version(original.stream) + 1;
  event.prev_hash = last.hash;
  event.hash = event_hash(event);
  insert_event(database_, event);
  return event;
}

std::uint64_t EventLog::version(std::string_view stream) const {
  sqlite::Statement query(database_, "SELECT max(version) FROM events WHERE stream = ?", stream);
  return query.step() ? query.u64(0) : 0;
}

Head EventLog::head() const {
  sqlite::Statement query(database_, "SELECT seq, hash FROM events ORDER BY seq DESC LIMIT 1");
  if (!query.step()) return {.seq = 0, .hash = zeros()};
  return {.seq = query.u64(0), .hash = query.text(1)};
}

std::string EventLog::hash_at(std::uint64_t seq) const {
  if (seq == 0) return zeros();
  sqlite::Statement query(database_, "SELECT hash FROM events WHERE seq = ?", seq);
  return query.step() ? query.text(0) : "";
}

std::vector<Event> EventLog::events(std::string_view stream, std::uint64_t after_version) const {
  const std::string where =
      stream.empty() ? "ORDER BY seq" : "WHERE stream = ? AND version > ? ORDER BY version";
  sqlite::Statement query(database_, std::string(kColumns) + where);
  if (!stream.empty()) query.bind_all(stream, after_version);
  std::vector<Event> found;
  while (query.step()) found.push_back(read_event(query));
  return found;
}

void EventLog::for_each(const std::function<void(const Event&)>& visit) const {
  sqlite::Statement query(database_, std::string(kColumns) + "ORDER BY seq");
  while (query.step()) visit(read_event(query));
}

std::optional<ChainFault> EventLog::verify_chain() const {
  sqlite::Statement query(database_, std::string(kColumns) + "ORDER BY seq");
  const auto read_next = [&query]() -> std::optional<Event> {
    if (!query.step()) return std::nullopt;
    return read_event(query);
  };
  std::map<std::string, std::uint64_t> versions;
  Head last{.seq = 0, .hash = zeros()};
  for (std::optional<Event> event = read_next(); event;) {
    const auto fault = [&](const std::string& field, const std::string& message) {
      return ChainFault{
          event->seq, field,
          fmt::format("event {} ({} of {}): {}", event->seq, event->type, event->stream, message)};
    };
    if (event->seq != last.seq + 1) {
      return fault("seq", fmt::format("event {} is missing here", last.seq + 1));
    }
    const std::uint64_t version = ++versions[event->stream];
    std::optional<Event> next = read_next();
    if (event_hash(*event) != event->hash) {
      const std::string field = changed_field(*event, last.hash, version, next);
      return fault(field, field == "content" ? "its hash does not match its content: stream, type, "
                                               "schema, recorded_at or payload was changed"
                                             : field + " was changed");
    }
    if (event->prev_hash != last.hash) {
      return fault("prev_hash", "it does not follow the event before it");
    }
    if (event->version != version) {
      return fault("version",
                   fmt::format("its version is {} and should be {}", event->version, version));
    }
    last = {.seq = event->seq, .hash = event->hash};
    event = std::move(next);
  }
  return std::nullopt;
}

}  // namespace shearcell
