// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/event_log.hpp"

#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <map>

#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"
#include "provenance/upcast.hpp"

namespace shearcell {

namespace {

constexpr std::string_view kColumns =
    "SELECT seq, stream, version, type, schema, recorded_at, payload, prev_hash, hash FROM events ";

std::string zeros() {
  return std::string(64, '0');
}

Event read_event(const sqlite::Statement& row) {
  return {.seq = row.u64(0),
          .stream = row.text(1),
          .version = row.u64(2),
          .type = row.text(3),
          .schema = row.u64(4),
          .recorded_at = row.text(5),
          .payload = row.text(6),
          .prev_hash = row.text(7),
          .hash = row.text(8)};
}

void insert_event(const sqlite::Database& database, const Event& event) {
  sqlite::Statement insert(
      database,
      "INSERT INTO events(seq, stream, version, type, schema, recorded_at, payload, prev_hash, "
      "hash) VALUES(?,?,?,?,?,?,?,?,?)");
  insert.bind(1, event.seq).bind(2, event.stream).bind(3, event.version).bind(4, event.type);
  insert.bind(5, event.schema).bind(6, event.recorded_at).bind(7, event.payload);
  insert.bind(8, event.prev_hash).bind(9, event.hash).run();
}

std::string now_utc() {
  using namespace std::chrono;
  const auto now = floor<milliseconds>(system_clock::now());
  const std::time_t seconds = system_clock::to_time_t(now);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", utc.tm_year + 1900,
                     utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                     now.time_since_epoch().count() % 1000);
}

/// Which field was changed, found by putting back what its neighbours say it was.
std::string changed_field(const Event& event, const std::string& prev_hash, std::uint64_t version,
                          const std::optional<Event>& next) {
  Event mended = event;
  mended.prev_hash = prev_hash;
  if (event_hash(mended) == event.hash) return "prev_hash";
  mended = event;
  mended.version = version;
  if (event_hash(mended) == event.hash) return "version";
  if (next && next->prev_hash == event_hash(event)) return "hash";
  return "content";
}

}  // namespace

nlohmann::json Event::body() const {
  nlohmann::json body = parse_json(payload);
  if (!body.is_object()) {
    throw StoreDamaged(
        fmt::format("event {} ({} of {}): its payload is not a JSON object (or one nested too "
                    "deeply); run `verify`",
                    seq, type, stream));
  }
  try {
    return upcast(type, schema, std::move(body));
  } catch (const StoreDamaged& newer) {
    throw StoreDamaged(fmt::format("event {} ({}): {}", seq, type, newer.what()));
  }
}

std::string event_hash(const Event& event) {
  Sha256 sha;
  const auto field = [&sha](std::string_view text) {
    sha.add(fmt::format("{}:", text.size())).add(text).add(",");
  };
  field("shearcell event 1");
  field(event.prev_hash);
  field(fmt::format("{}", event.seq));
  field(event.stream);
  field(fmt::format("{}", event.version));
  field(event.type);
  field(fmt::format("{}", event.schema));
  field(event.recorded_at);
  field(event.payload);
  return sha.hex();
}

EventLog::EventLog(sqlite::Database& database) : database_(database) {}

std::vector<Event> EventLog::append(const sqlite::WriteTransaction&, std::string_view stream,
                                    std::uint64_t expected_version,
                                    std::span<const NewEvent> events) {
  const std::uint64_t found = version(stream);
  if (found != expected_version) {
    throw ConcurrencyConflict(
        fmt::format("{}: stream {} is at version {}, and version {} was expected: another process "
                    "wrote to it; read it again",
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
    event.schema = newest_schema(fresh.type);
    event.recorded_at = now_utc();
    // Paths may hold bytes that are not UTF-8, and JSON cannot: such bytes become U+FFFD.
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
  sqlite::Statement query(database_, "SELECT max(version) FROM events WHERE stream = ?");
  query.bind(1, stream);
  return query.step() ? query.u64(0) : 0;
}

Head EventLog::head() const {
  sqlite::Statement query(database_, "SELECT seq, hash FROM events ORDER BY seq DESC LIMIT 1");
  if (!query.step()) return {.seq = 0, .hash = zeros()};
  return {.seq = query.u64(0), .hash = query.text(1)};
}

std::string EventLog::hash_at(std::uint64_t seq) const {
  if (seq == 0) return zeros();
  sqlite::Statement query(database_, "SELECT hash FROM events WHERE seq = ?");
  return query.bind(1, seq).step() ? query.text(0) : "";
}

std::vector<Event> EventLog::events(std::string_view stream, std::uint64_t after_version) const {
  const std::string where =
      stream.empty() ? "ORDER BY seq" : "WHERE stream = ? AND version > ? ORDER BY version";
  sqlite::Statement query(database_, std::string(kColumns) + where);
  if (!stream.empty()) query.bind(1, stream).bind(2, after_version);
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
      return fault("seq", fmt::format("event {} should stand here and is missing", last.seq + 1));
    }
    const std::uint64_t version = ++versions[event->stream];
    std::optional<Event> next = read_next();
    if (event_hash(*event) != event->hash) {
      const std::string field = changed_field(*event, last.hash, version, next);
      return fault(field, field == "content" ? "its hash does not fit its content: stream, type, "
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
