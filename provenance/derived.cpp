// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/derived.hpp"

#include <fmt/format.h>

#include <system_error>

#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/limits.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

namespace fs = std::filesystem;

/// SQLite's application_id of the file: "shcd" in ASCII.
constexpr std::int64_t kApplicationId = 0x73686364;
constexpr std::int64_t kLayout = 1;
constexpr std::size_t kDigits = 32;  // of a hash in Digests

constexpr const char* kDerivedTable = R"sql(
CREATE TABLE derived(
  checkpoint TEXT NOT NULL,
  measure TEXT NOT NULL,
  version INTEGER NOT NULL,
  sha256 TEXT NOT NULL,
  content BLOB NOT NULL,
  PRIMARY KEY (checkpoint, measure, version)
) STRICT, WITHOUT ROWID;
)sql";

/// Hash of key and content. Because the key is included, content under a wrong key is detected.
std::string digest(const DerivedKey& key, std::span<const std::byte> content) {
  return Sha256()
      .add_fields("shearcell derived 1", key.checkpoint, key.measure, key.version)
      .add(content)
      .hex();
}

/// The name of an object in Digests.
std::string digest_name(const DerivedKey& key) {
  constexpr std::size_t name_digits = 12;
  return fmt::format("{}-{:.{}}", key.measure.substr(0, key.measure.find(' ')),
                     Sha256().add_fields(key.measure, key.version).hex(), name_digits);
}

/// The name under which the n-th damaged file is kept.
fs::path damaged_name(const fs::path& file, int n) {
  return fmt::format("{}.damaged-{}", file.string(), n);
}

/// Renames a damaged file instead of deleting it: it may hold the only measures of pruned
/// checkpoints. Also renames its journal, which SQLite would otherwise apply to the new database.
void set_aside(const fs::path& file) {
  std::error_code ignored;
  int n = 1;
  while (fs::exists(damaged_name(file, n), ignored)) ++n;
  const fs::path kept = damaged_name(file, n);
  fs::rename(file.string() + "-journal", kept.string() + "-journal", ignored);
  fs::rename(file, kept, ignored);
}

}  // namespace

Digests::value_type digest_entry(const DerivedObject& object) {
  return {digest_name(object.key), digest(object.key, object.content).substr(0, kDigits)};
}

DerivedCache::DerivedCache(const fs::path& store_folder, Access access)
    : file_(store_folder / kFile), read_only_(access == Access::read) {
  attempt([](sqlite::Database&) {});
}

void DerivedCache::open() {
  const auto type = fs::symlink_status(file_).type();
  if (type != fs::file_type::regular && type != fs::file_type::not_found) {
    throw NotOurs(file_.string() +
                  ": the cache of measures must be a file, but this is a folder, link or device; "
                  "move it to another place");
  }
  const bool empty = type == fs::file_type::not_found || fs::is_empty(file_);
  if (read_only_ && empty) return;
  database_.emplace(file_, read_only_ ? Access::read : Access::create);
  sqlite::Database& database = *database_;
  // Nothing is synced, because objects damaged by a power cut are detected and computed again.
  database.execute("PRAGMA cell_size_check=ON; PRAGMA synchronous=OFF;");
  if (read_only_) database.execute("PRAGMA query_only=ON");
  if (!read_only_ && database.integer("PRAGMA page_count") == 0) {
    database.create_tables(fmt::format("{} PRAGMA application_id={}; PRAGMA user_version={};",
                                       kDerivedTable, kApplicationId, kLayout));
  }
  if (database.integer("PRAGMA application_id") != kApplicationId) {
    throw NotOurs(file_.string() +
                  ": this database belongs to another program; move it to another "
                  "place");
  }
  const std::int64_t layout = database.integer("PRAGMA user_version");
  if (layout > kLayout) {
    throw NotOurs(file_.string() +
                  ": a newer version of this program made this cache of measures; "
                  "use that version, or move the file to another place");
  }
  if (layout != kLayout) {
    throw StoreDamaged(file_.string() + ": the database has an unknown layout version");
  }
  // Another program may have added a trigger. SQLite would run the trigger at every insert.
  sqlite::Statement odd(database, "SELECT 1 FROM sqlite_schema WHERE instr(?1, sql) = 0",
                        kDerivedTable);
  if (odd.step()) throw StoreDamaged(file_.string() + ": it has tables of another program");
}

template <typename Work>
void DerivedCache::attempt(Work&& work) {
  const auto give_up = [this](const std::string& why) {
    database_.reset();
    trouble_ = why;
  };
  for (const bool first : {true, false}) {
    if (!trouble_.empty()) return;
    try {
      if (!database_) open();
      if (database_) work(*database_);
      return;
    } catch (const StoreDamaged& damage) {
      if (read_only_) return give_up(file_.string() + ": it is not a database of measures");
      if (!first) return give_up(damage.what());
      database_.reset();
      set_aside(file_);
    } catch (const NotOurs& foreign) {
      return give_up(foreign.what());
    } catch (const std::exception& problem) {
      unread_ = true;
      return give_up(problem.what());
    }
  }
}

std::string DerivedCache::replaced() const {
  std::error_code ignored;
  const fs::path kept = damaged_name(file_, 1);
  if (!fs::exists(kept, ignored)) return "";
  return fmt::format(
      "{}: the file was damaged, so measures of pruned checkpoints are missing. The damaged file "
      "is kept as {}. Restore the file from a backup, or recompute the checkpoints by "
      "`shearcell regenerate --all`",
      file_.string(), kept.filename().string());
}

std::vector<std::optional<std::vector<std::byte>>> DerivedCache::get(
    std::span<const DerivedKey> keys) {
  std::vector<std::optional<std::vector<std::byte>>> found;
  attempt([&](sqlite::Database& database) {
    found.assign(keys.size(), std::nullopt);
    const sqlite::ReadTransaction snapshot(database);
    for (std::size_t k = 0; k < keys.size(); ++k) {
      sqlite::Statement query(database,
                              "SELECT content, sha256 FROM derived WHERE checkpoint = ? AND "
                              "measure = ? AND version = ?",
                              keys[k].checkpoint, keys[k].measure, keys[k].version);
      if (!query.step()) continue;
      std::vector<std::byte> content = query.blob(0);
      if (digest(keys[k], content) == query.text(1)) found[k] = std::move(content);
    }
  });
  found.resize(keys.size());
  return found;
}

Digests DerivedCache::digests(const std::string& checkpoint, bool damaged_too) {
  Digests found;
  attempt([&](sqlite::Database& database) {
    sqlite::Statement query(
        database, "SELECT measure, version, content, sha256 FROM derived WHERE checkpoint = ?",
        checkpoint);
    while (query.step()) {
      const DerivedKey key{checkpoint, query.text(0), query.u64(1)};
      const std::string sha256 = digest(key, query.blob(2));
      const bool intact = sha256 == query.text(3);
      if (!intact && !damaged_too) continue;
      found.emplace(digest_name(key), sha256.substr(0, intact ? kDigits : 0));
    }
  });
  return found;
}

void DerivedCache::forget(const std::string& checkpoint) {
  attempt([&](sqlite::Database& database) {
    sqlite::Statement(database, "DELETE FROM derived WHERE checkpoint = ?", checkpoint).run();
  });
}

void DerivedCache::put(std::span<const DerivedObject> objects) {
  attempt([&](sqlite::Database& database) {
    sqlite::WriteTransaction lock(database);
    for (const DerivedObject& object : objects) {
      if (object.content.size() > StoreLimits::value_bytes) continue;  // too large to store
      const DerivedKey& key = object.key;
      sqlite::Statement(database, "INSERT OR REPLACE INTO derived VALUES(?,?,?,?,?)",
                        key.checkpoint, key.measure, key.version, digest(key, object.content),
                        object.content)
          .run();
    }
    lock.commit();
  });
}

}  // namespace shearcell
