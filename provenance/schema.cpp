// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/schema.hpp"

#include <fmt/format.h>

#include <array>
#include <set>
#include <string>

#include "provenance/errors.hpp"
#include "provenance/lease.hpp"
#include "provenance/projections.hpp"

namespace shearcell {

namespace {

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

/// Converts a store from schema `from` to the next one. It never changes the table `events`.
struct Migration {
  std::int64_t from;
  void (*migrate)(sqlite::Database&);
};

constexpr std::array<Migration, 1> kMigrations = {{
    {1, [](sqlite::Database& database) { create_leases(database); }},
}};
static_assert(kMigrations.back().from + 1 == kSchemaVersion);

void create_tables(sqlite::Database& database) {
  sqlite::WriteTransaction lock(database);
  // Another process may have created them while this one waited for the lock.
  if (database.integer("SELECT count(*) FROM sqlite_schema") == 0) {
    database.execute(kEvents);
    create_projections(database);
    create_leases(database);
    database.execute(fmt::format("PRAGMA application_id={}; PRAGMA user_version={};",
                                 kApplicationId, kSchemaVersion));
  }
  lock.commit();
}

/// A forged schema could run its own statements whenever a table is read or written, so all schema
/// statements must be ones that this program writes. Missing tables fail when they are used.
void require_own_schema(const sqlite::Database& database) {
  sqlite::Database own = sqlite::Database::in_memory();
  create_tables(own);
  own.execute("ANALYZE");  // its tables are allowed; they hold only estimates
  constexpr const char* statements = "SELECT sql, name FROM sqlite_schema WHERE sql IS NOT NULL";
  std::set<std::string> known;
  for (sqlite::Statement row(own, statements); row.step();) known.insert(row.text(0));
  for (sqlite::Statement row(database, statements); row.step();) {
    if (known.contains(row.text(0))) continue;
    throw StoreDamaged(fmt::format(
        "{}: the database holds '{}', which no store of schema {} has; restore it from a backup",
        database.name(), row.text(1), kSchemaVersion));
  }
}

void require_known_schema(sqlite::Database& database) {
  if (database.integer("PRAGMA application_id") != kApplicationId) {
    throw StoreDamaged(
        fmt::format("{}: this SQLite database belongs to another program; name another store "
                    "folder",
                    database.name()));
  }
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version > kSchemaVersion) {
    throw StoreDamaged(fmt::format(
        "{}: the store has schema {}, and this program knows schemas up to {}; use the newer "
        "shearcell that wrote it",
        database.name(), version, kSchemaVersion));
  }
  if (version < 1) {
    throw StoreDamaged(
        fmt::format("{}: the store has schema {}, which never existed; restore the "
                    "file from a backup",
                    database.name(), version));
  }
}

/// One transaction for each step, so an interrupted migration leaves the previous version.
void migrate(sqlite::Database& database) {
  for (const Migration& step : kMigrations) {
    if (database.integer("PRAGMA user_version") > step.from) continue;
    sqlite::WriteTransaction lock(database);
    // Another process may have taken the step while this one waited for the lock.
    if (database.integer("PRAGMA user_version") == step.from) {
      step.migrate(database);
      database.execute(fmt::format("PRAGMA user_version={}", step.from + 1));
    }
    lock.commit();
  }
}

}  // namespace

sqlite::Database open_database(const std::filesystem::path& file, sqlite::Open mode,
                               bool read_only) {
  sqlite::Database database(file, mode);
  // Rollback journal instead of WAL: SQLite before 3.51.3 can lose committed transactions when
  // several connections checkpoint a WAL at once. EXTRA also syncs the folder after the journal is
  // deleted, so that a committed event survives a power cut.
  database.execute(
      "PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON; PRAGMA foreign_keys=ON;"
      "PRAGMA synchronous=EXTRA;");
  if (database.integer("PRAGMA page_count") == 0) {
    // A new store starts with an empty file; with objects beside it, the log was lost.
    if (mode != sqlite::Open::create || std::filesystem::exists(file.parent_path() / "objects")) {
      throw StoreDamaged(file.string() +
                         ": the log is empty; restore it from a backup, or name another store");
    }
    create_tables(database);
  }
  require_known_schema(database);
  require_own_schema(database);
  database.execute(read_only ? "PRAGMA query_only=ON" : "PRAGMA journal_mode=DELETE");
  if (!read_only) migrate(database);
  return database;
}

}  // namespace shearcell
