// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/sqlite.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "provenance/io/file.hpp"
#include "provenance/limits.hpp"

namespace shearcell::sqlite {

namespace {

constexpr int kBusyTimeoutMs = 30'000;
// SQLite's limit of 512 bytes minus the longest suffix, "-journal".
constexpr std::size_t kLongestName = 504;
constexpr const char* kInMemory = ":memory:";

void require_plain_files(const std::string& name) {
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) {
    const std::string file = name + suffix;
    struct stat found {};
    if (lstat(file.c_str(), &found) != 0) continue;
    if (!S_ISREG(found.st_mode)) {
      throw StoreDamaged(fmt::format(
          "{}: a database file must be a regular file, but this is a folder, link or device; "
          "remove it or choose another store folder",
          file));
    }
    if (found.st_nlink < 2) continue;
    throw StoreDamaged(fmt::format(
        "{0}: the file has {1} names (hard links), so using this store would damage another store; "
        "copy stores with `cp -a`, and separate this file with `cp -p {0} {0}.own && mv {0}.own "
        "{0}`",
        file, found.st_nlink));
  }
}

}  // namespace

std::string full_name(const std::filesystem::path& file) {
  // The path is made absolute because SQLite reads a relative path "file:x" as a URI.
  std::string name = std::filesystem::absolute(file).string();
  if (name.size() <= kLongestName) return name;
  throw UsageError(
      fmt::format("{}: the full path has {} bytes, and SQLite opens at most {}; use a shorter path",
                  file.string(), name.size(), kLongestName));
}

Database::Database(const std::filesystem::path& file, Access access)
    : name_(file.string()), handle_(nullptr, sqlite3_close_v2) {
  if (name_ != kInMemory) {
    full_name_ = sqlite::full_name(file);
    require_plain_files(full_name_);
  }
  // SQLite creates files with mode 0644. In a folder that a group shares, files need mode 0666
  // minus umask.
  if (access == Access::create && !full_name_.empty()) {
    Descriptor(open(full_name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  }
  sqlite3* handle = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE |
                    (access == Access::create ? SQLITE_OPEN_CREATE : 0);
  const int code =
      sqlite3_open_v2(full_name_.empty() ? kInMemory : full_name_.c_str(), &handle, flags, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) fail(code, "open");
  struct stat opened {};
  if (!full_name_.empty() && stat(full_name_.c_str(), &opened) == 0) {
    device_ = opened.st_dev;
    inode_ = opened.st_ino;
  }
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  // SQLite limits the size of a whole row. The row limit exceeds the limit of one value by `beside`
  // bytes, which leaves room for the other columns.
  constexpr std::size_t beside = 64 << 10;
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, static_cast<int>(StoreLimits::value_bytes + beside));
  sqlite3_limit(handle, SQLITE_LIMIT_ATTACHED, 0);
  // A forged schema could have views and triggers that run forever or that open other files.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
}

Database Database::in_memory(const std::string& name) {
  Database database(kInMemory, Access::create);
  database.name_ = name;
  return database;
}

void Database::require_same_file() const {
  if (inode_ == 0) return;
  struct stat now {};
  if (stat(full_name_.c_str(), &now) == 0 && now.st_dev == device_ && now.st_ino == inode_) return;
  throw MachineError(
      fmt::format("{}: the file was moved, replaced or deleted while this program used it, so "
                  "nothing more is written; give its new folder with --store and try again",
                  name_));
}

void Database::require_in_place() const {
  if (inode_ == 0 || sqlite3_get_autocommit(handle_.get()) == 0) return;
  require_same_file();
  require_plain_files(full_name_);
}

void Database::require_journal_can_be_played_back(int code) const {
  const int kind = code & 0xff;
  if (kind != SQLITE_READONLY && kind != SQLITE_CANTOPEN && kind != SQLITE_IOERR) return;
  const std::filesystem::path file = full_name_, journal = full_name_ + "-journal";
  if (!std::filesystem::exists(journal)) return;
  for (const std::filesystem::path& path : {journal, file, file.parent_path()}) {
    if (faccessat(AT_FDCWD, path.c_str(), R_OK | W_OK, AT_EACCESS) == 0) continue;
    throw MachineError(fmt::format(
        "{}: a program was writing to this store when it was killed or the disk became read-only. "
        "The next program that opens the store uses {} to undo the unfinished write, but you "
        "cannot write to {} ({}). Nothing that was recorded is lost. Copy the whole folder to a "
        "disk where you can write (`cp -r`, then `chmod -R u+w` on the copy) and use the copy, or "
        "open the store once as a user who can write to it",
        name_, journal.filename().string(), path.string(), std::generic_category().message(errno)));
  }
}

void Database::require_readable(std::string_view doing) const {
  if (errno != EIO) return;
  throw MachineError(fmt::format("{}: cannot {}: {}; check the disk and try again", name_, doing,
                                 std::generic_category().message(EIO)));
}

void Database::fail(int code, std::string_view doing) const {
  require_readable(doing);
  if ((code & 0xff) == SQLITE_NOMEM || code == SQLITE_IOERR_NOMEM) {
    if (const auto no_memory = std::get_new_handler()) no_memory();
    throw std::bad_alloc();
  }
  require_same_file();  // SQLite reports a moved or deleted file as an I/O error
  require_journal_can_be_played_back(code);
  const char* reason = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw MachineError(
          fmt::format("{}: another process kept the store locked for {} s; try again when "
                      "that process has ended",
                      name_, kBusyTimeoutMs / 1000));
    case SQLITE_FULL:
      throw MachineError(fmt::format(
          "{}: the disk is full; free some space and try again. Nothing that was recorded is lost",
          name_));
    case SQLITE_TOOBIG:
      throw StoreDamaged(fmt::format(
          "{}: a value in the database exceeds {} MiB, the largest size that this program writes "
          "or reads; restore the database from a backup",
          name_, StoreLimits::value_bytes >> 20));
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_CONSTRAINT:
    case SQLITE_ERROR:  // our SQL fails only on tables that another program made
    case SQLITE_MISMATCH:
      throw StoreDamaged(
          fmt::format("{}: the database is damaged ({}); restore it from a backup, or check "
                      "with `shearcell verify` whether the log is readable",
                      name_, reason));
    default:
      throw std::runtime_error(fmt::format("{}: cannot {}: {}", name_, doing, reason));
  }
}

void Database::execute(const std::string& sql) {
  require_in_place();
  errno = 0;
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code, "write");
}

void Database::create_tables(const std::string& sql) {
  WriteTransaction lock(*this);
  // Another process may have created the tables while this process waited for the lock.
  if (integer("SELECT count(*) FROM sqlite_schema") == 0) execute(sql);
  lock.commit();
}

std::int64_t Database::integer(const std::string& sql) {
  Statement query(*this, sql);
  if (!query.step()) fail(SQLITE_CORRUPT, "read");
  return static_cast<std::int64_t>(query.u64(0));
}

Database::Prepared Statement::prepared() const {
  database_->require_in_place();
  if (auto idle = database_->idle_.extract(sql_)) {
    Database::Prepared found = std::move(idle.mapped());
    return found;
  }
  sqlite3_stmt* handle = nullptr;
  errno = 0;
  check(sqlite3_prepare_v2(database_->handle(), sql_.data(), static_cast<int>(sql_.size()), &handle,
                           nullptr));
  return {handle, sqlite3_finalize};
}

Statement::~Statement() {
  constexpr std::size_t kMostIdle = 64;
  if (database_->idle_.size() >= kMostIdle) return;
  // Without a reset, an unfinished statement would keep its lock on the file.
  sqlite3_reset(handle_.get());
  sqlite3_clear_bindings(handle_.get());
  database_->idle_.emplace(std::move(sql_), std::move(handle_));
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) database_->fail(code, "read or write");
}

void Statement::require_fits(std::size_t bytes) const {
  if (bytes <= StoreLimits::value_bytes) return;
  throw UsageError(fmt::format(
      "{}: a record of {} MiB was not added, because a record may have at most {} MiB; choose "
      "fewer runs or checkpoints",
      database_->name(), bytes >> 20, StoreLimits::value_bytes >> 20));
}

void Statement::bind(int parameter, std::string_view text) {
  require_fits(text.size());
  check(sqlite3_bind_text64(handle_.get(), parameter, text.data() ? text.data() : "", text.size(),
                            SQLITE_TRANSIENT, SQLITE_UTF8));
}

void Statement::bind(int parameter, std::uint64_t value) {
  check(sqlite3_bind_int64(handle_.get(), parameter, static_cast<std::int64_t>(value)));
}

void Statement::bind(int parameter, double value) {
  check(sqlite3_bind_double(handle_.get(), parameter, value));
}

void Statement::bind(int parameter, std::span<const std::byte> blob) {
  require_fits(blob.size());
  // SQLite would bind NULL for a null pointer, so an empty blob points to an empty text.
  check(sqlite3_bind_blob64(handle_.get(), parameter,
                            blob.empty() ? static_cast<const void*>("") : blob.data(), blob.size(),
                            SQLITE_TRANSIENT));
}

bool Statement::step() {
  errno = 0;
  const int code = sqlite3_step(handle_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_->fail(code, "read or write");
  return false;
}

void Statement::run() {
  while (step()) {
  }
}

std::string Statement::text(int column) const {
  const auto* text = sqlite3_column_text(handle_.get(), column);
  if (!text) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

std::uint64_t Statement::u64(int column) const {
  return static_cast<std::uint64_t>(sqlite3_column_int64(handle_.get(), column));
}

double Statement::f64(int column) const {
  return sqlite3_column_double(handle_.get(), column);
}

std::vector<std::byte> Statement::blob(int column) const {
  const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(handle_.get(), column));
  if (bytes == nullptr) return {};
  return {bytes, bytes + sqlite3_column_bytes(handle_.get(), column)};
}

std::vector<std::string> Statement::cells() const {
  std::vector<std::string> row;
  for (int column = 0; column < sqlite3_column_count(handle_.get()); ++column) {
    const int type = sqlite3_column_type(handle_.get(), column);  // text() changes the type
    const std::string value = type == SQLITE_FLOAT  ? fmt::format("{:a}", f64(column))
                              : type == SQLITE_NULL ? "NULL"
                              : type == SQLITE_TEXT ? "'" + text(column) + "'"
                                                    : text(column);
    row.push_back(fmt::format("{} = {}", sqlite3_column_name(handle_.get(), column), value));
  }
  return row;
}

Transaction::Transaction(Database& database, const std::string& begin, bool nested)
    : database_(database), open_(!nested || sqlite3_get_autocommit(database.handle()) != 0) {
  if (open_) database_.execute(begin);
}

Transaction::~Transaction() {
  // After a failed statement SQLite may already have rolled back. ROLLBACK then changes nothing.
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace shearcell::sqlite
