// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/event_log.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <map>
#include <system_error>

#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/lease.hpp"
#include "provenance/projections.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

/// SQLite's application_id of a store: "shcl" in ASCII.
constexpr std::int64_t kStoreApplicationId = 0x7368636c;

constexpr const char* kEvents = R"sql(
CREATE TABLE events(
  seq INTEGER PRIMARY KEY,
  stream TEXT NOT NULL,
  version INTEGER NOT NULL CHECK (version > 0),
  type TEXT NOT NULL,
  schema INTEGER NOT NULL CHECK (schema > 0),
  recorded_at TEXT NOT NULL,
  payload TEXT NOT NULL,
  prev_hash TEXT NOT NULL,
  hash TEXT NOT NULL,
  UNIQUE (stream, version)
) STRICT;
CREATE TRIGGER events_are_never_updated BEFORE UPDATE ON events
BEGIN SELECT RAISE(ABORT, 'events are never updated'); END;
CREATE TRIGGER events_are_never_deleted BEFORE DELETE ON events
BEGIN SELECT RAISE(ABORT, 'events are never deleted'); END;
)sql";

/// The SQL statements that create the tables of a new store.
std::string own_tables() {
  return fmt::format("{}{}{}PRAGMA application_id={}; PRAGMA user_version={};", kEvents,
                     projection_tables, lease_table, kStoreApplicationId, kSchemaVersion);
}

/// Creates the log under a temporary name and then renames it, so that a killed program leaves no
/// partial log. Does nothing if another program has created the log. If the file system does
/// not support RENAME_NOREPLACE, the caller creates the log under its final name.
void create_whole(const std::filesystem::path& file) {
  const std::filesystem::path whole =
      file.parent_path() / fmt::format(".{}.tmp-{}-0", file.filename().string(), getpid());
  {
    sqlite::Database database(whole, Access::create);
    database.execute("PRAGMA journal_mode=MEMORY");
    database.create_tables(own_tables());
  }
  // The folder is synced when the first event is written.
  if (renameat2(AT_FDCWD, whole.c_str(), AT_FDCWD, file.c_str(), RENAME_NOREPLACE) != 0) {
    unlink(whole.c_str());
  }
}

/// Throws if the schema has a statement that this program does not write, because a forged schema
/// could contain SQL that runs whenever a table is read or written. A missing table causes an error
/// only when it is used. Derived tables of an older schema may differ, because they are not read.
void require_own_schema(sqlite::Database& database) {
  // SQLite's own statistics tables are allowed, too.
  const std::string own = own_tables() +
                          "CREATE TABLE sqlite_stat1(tbl,idx,stat);"
                          "CREATE TABLE sqlite_stat4(tbl,idx,neq,nlt,ndlt,sample);";
  const bool older = database.integer("PRAGMA user_version") < kSchemaVersion;
  sqlite::Statement row(database, "SELECT sql, name FROM sqlite_schema WHERE instr(?, sql) = 0",
                        own);
  while (row.step()) {
    const std::string sql = row.text(0), name = row.text(1);
    const bool derived = std::ranges::count(projected_tables, name) > 0;
    if (older && derived && sql.starts_with("CREATE TABLE ")) continue;
    throw StoreDamaged(fmt::format(
        "{}: the database has '{}', which is not part of schema {}; restore the file from a backup",
        database.name(), name, kSchemaVersion));
  }
}

void require_known_schema(sqlite::Database& database) {
  const auto refuse = [&](const std::string& why) {
    throw StoreDamaged(fmt::format("{}: {}", database.name(), why));
  };
  if (database.integer("PRAGMA application_id") != kStoreApplicationId) {
    refuse("this SQLite database belongs to another program; choose another store folder");
  }
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version < 1 || version > kSchemaVersion) {
    refuse(
        fmt::format("the store has schema {}, and this program knows the schemas 1 to {}; use the "
                    "newer shearcell that wrote it, or restore the file from a backup",
                    version, kSchemaVersion));
  }
}

/// Migrates an older schema to the newest in one transaction, so an interrupted migration leaves
/// the older schema. The table `events` is not changed. Schema 2 added leases. Schema 3 added the
/// newest manifest of each experiment and scale, what is requested of a run, and why a run ended.
void migrate(sqlite::Database& database) {
  if (database.integer("PRAGMA user_version") == kSchemaVersion) return;
  sqlite::WriteTransaction lock(database);
  // Another process may have migrated the store while this process waited for the lock.
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version == 1) database.execute(lease_table);
  if (version < kSchemaVersion) {
    derive_projections(database, EventLog(database), lock);
    database.execute(fmt::format("PRAGMA user_version={}", kSchemaVersion));
  }
  lock.commit();
}

/// Requires write access to the file and to its folder, where SQLite creates the journal. Otherwise
/// SQLite would open the file for reading only and fail at the first event.
void require_writable(const std::filesystem::path& file) {
  for (const std::filesystem::path& path : {file, file.parent_path()}) {
    if (faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0 || errno == ENOENT) continue;
    throw MachineError(fmt::format(
        "{}: this user cannot write to it ({}), but this command changes the store; change the "
        "permissions, or copy the store to a folder of your own",
        path.string(), std::generic_category().message(errno)));
  }
}

constexpr const char* kSelect = "SELECT * FROM events ";

Event read_event(const sqlite::Statement& row) {
  Event e;
  row.get(e.seq, e.stream, e.version, e.type, e.schema, e.recorded_at, e.payload, e.prev_hash,
          e.hash);
  return e;
}

}  // namespace

void require_no_results(const std::filesystem::path& log, const std::string& state) {
  namespace fs = std::filesystem;
  const fs::path folder = log.parent_path(), cache = folder / DerivedCache::kFile;
  std::error_code unreadable;
  bool found = fs::exists(cache) && !fs::is_empty(cache, unreadable);
  for (fs::recursive_directory_iterator entry(folder / "objects", unreadable), end;
       !found && entry != end; entry.increment(unreadable)) {
    found = entry->path().extension() == ".h5";
  }
  // An unreadable folder may have results.
  if (!found && (!unreadable || unreadable == std::errc::no_such_file_or_directory)) return;
  throw StoreDamaged(fmt::format(
      "{}: the log is {}, but the store has checkpoints or measures that were recorded in a log; "
      "restore the log from a backup. Without it, choose another store with --store and compute "
      "the runs again",
      log.string(), state));
}

sqlite::Database open_database(const std::filesystem::path& file, Access access) {
  if (access != Access::read) require_writable(file);
  if (access == Access::create && !std::filesystem::exists(file)) create_whole(file);
  sqlite::Database database(file, access);
  // A rollback journal is used instead of WAL, because SQLite before 3.51.3 can lose committed
  // transactions when several connections checkpoint a WAL at once. EXTRA also syncs the folder
  // after the journal is deleted, so that a committed event survives a power cut.
  database.execute(
      "PRAGMA cell_size_check=ON; PRAGMA foreign_keys=ON;"
      "PRAGMA synchronous=EXTRA;");
  if (database.integer("PRAGMA page_count") == 0) {
    require_no_results(file, "empty (0 bytes)");
    if (access != Access::create) {
      throw NotFound(file.string() +
                     ": the log is empty, because the creation of this store was interrupted; "
                     "`shearcell run` with a manifest completes the store");
    }
    database.create_tables(own_tables());
  }
  require_known_schema(database);
  require_own_schema(database);
  const bool read_only = access == Access::read;
  const bool older = database.integer("PRAGMA user_version") < kSchemaVersion;
  if (read_only && older) shadow_projections(database, EventLog(database));
  database.execute(read_only ? "PRAGMA query_only=ON" : "PRAGMA journal_mode=DELETE");
  if (!read_only) migrate(database);
  return database;
}

std::string event_hash(const Event& event) {
  return Sha256()
      .add_fields("shearcell event 1", event.prev_hash, event.seq, event.stream, event.version,
                  event.type, event.schema, event.recorded_at, event.payload)
      .hex();
}

std::string run_stream(std::string_view run) {
  return fmt::format("run/{}", run);
}

std::optional<std::string> run_of(const Event& event) {
  if (!event.stream.starts_with("run/")) return std::nullopt;
  return event.stream.substr(4);
}

std::string utc_text(std::int64_t ms) {
  const std::int64_t within = (ms % 1000 + 1000) % 1000;  // not negative, even before 1970
  return fmt::format("{:%FT%T}.{:03}Z", fmt::gmtime(std::time_t{(ms - within) / 1000}), within);
}

Event EventLog::append(const sqlite::WriteTransaction& lock, std::string_view stream,
                       const NewEvent& event) {
  Event complete;
  complete.stream = stream;
  complete.type = event.type;
  complete.schema = events::newest_schema(event.type);
  complete.recorded_at = std::max(utc_text(static_cast<std::int64_t>(now_ms())), event.not_before);
  // Bytes that are not UTF-8, for example in a path, become U+FFFD.
  complete.payload = event.payload.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return append_copy(lock, std::move(complete));
}

Event EventLog::append_copy(const sqlite::WriteTransaction&, Event event) {
  const Head last = head();
  event.seq = last.seq + 1;
  event.version = version(event.stream) + 1;
  event.prev_hash = last.hash;
  event.hash = event_hash(event);
  sqlite::Statement(database_, "INSERT INTO events VALUES(?,?,?,?,?,?,?,?,?)", event.seq,
                    event.stream, event.version, event.type, event.schema, event.recorded_at,
                    event.payload, event.prev_hash, event.hash)
      .run();
  return event;
}

std::uint64_t EventLog::version(std::string_view stream) const {
  sqlite::Statement query(database_, "SELECT max(version) FROM events WHERE stream = ?", stream);
  return query.step() ? query.u64(0) : 0;
}

Head EventLog::head() const {
  sqlite::Statement query(database_, "SELECT seq, hash FROM events ORDER BY seq DESC LIMIT 1");
  if (!query.step()) return {.seq = 0, .hash = std::string(64, '0')};
  return {.seq = query.u64(0), .hash = query.text(1)};
}

std::string EventLog::hash_at(std::uint64_t seq) const {
  if (seq == 0) return std::string(64, '0');
  sqlite::Statement query(database_, "SELECT hash FROM events WHERE seq = ?", seq);
  return query.step() ? query.text(0) : "";
}

std::vector<Event> EventLog::events(std::string_view stream, std::string_view type) const {
  const std::string of_stream = stream.empty() ? "?1 = ''" : "stream = ?1";
  sqlite::Statement query(database_,
                          fmt::format("{} WHERE {} AND (?2 = '' OR type = ?2) ORDER BY {}", kSelect,
                                      of_stream, stream.empty() ? "seq" : "version"),
                          stream, type);
  return query.all(read_event);
}

void EventLog::for_each(const std::function<void(const Event&)>& visit, std::uint64_t from) const {
  sqlite::Statement query(database_, std::string(kSelect) + "WHERE seq >= ? ORDER BY seq", from);
  while (query.step()) visit(read_event(query));
}

std::optional<ChainFault> EventLog::verify_chain(std::uint64_t from) const {
  std::optional<ChainFault> first;
  std::map<std::string, std::uint64_t> versions;
  Head last{.seq = from - 1, .hash = hash_at(from - 1)};
  for_each(
      [&](const Event& event) {
        if (first) return;
        const std::uint64_t version = from > 1 ? event.version : ++versions[event.stream];
        std::string fault;
        if (event.seq != last.seq + 1) {
          fault = fmt::format("event {} is missing here", last.seq + 1);
        } else if (event_hash(event) != event.hash) {
          fault = "its hash does not match its content: one of its fields was changed";
        } else if (event.prev_hash != last.hash) {
          fault = "prev_hash is not the previous event's hash";
        } else if (event.version != version) {
          fault = fmt::format("its version is {}, but should be {}", event.version, version);
        }
        if (!fault.empty()) {
          first = {event.seq, fmt::format("event {} ({} of {}): {}", event.seq, event.type,
                                          event.stream, fault)};
        }
        last = {.seq = event.seq, .hash = event.hash};
      },
      from);
  return first;
}

}  // namespace shearcell
