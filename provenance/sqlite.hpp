// SPDX-License-Identifier: GPL-3.0-or-later
// A small C++ interface to SQLite: ownership, typed binding and reading, exceptions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "provenance/errors.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace shearcell {

/// How a file or store is opened.
enum class Access {
  create,  ///< read and write; create the file if it is missing
  write,   ///< read and write; the file must exist
  read     ///< the file must exist; functions that write throw std::logic_error
};

}  // namespace shearcell

namespace shearcell::sqlite {

/// The absolute path of a database. Throws UsageError when SQLite does not allow its length.
std::string full_name(const std::filesystem::path& file);

/// A connection to one database, for one thread at a time. Exceptions name the file. All functions
/// throw StoreDamaged when the file is not a valid database; MachineError when another process kept
/// the file locked, or when the file was moved, replaced or deleted; and std::runtime_error when
/// the machine fails (disk full, no permission).
///
/// The database file and its journal must be regular files without hard links. SQLite derives the
/// name of the journal from the name of the file. If the file had a second name, SQLite could miss
/// its journal or play back the journal of another database.
class Database {
 public:
  /// Even with Access::read SQLite may write: it rolls back the transaction of a killed program.
  Database(const std::filesystem::path& file, Access access);
  /// A new database in memory. `name` is its name in error messages.
  static Database in_memory(const std::string& name = ":memory:");

  /// Runs SQL statements and ignores the rows that they return.
  void execute(const std::string& sql);
  /// Runs SQL statements in one transaction. Does nothing if the database already has tables.
  void create_tables(const std::string& sql);
  /// The value in the first column of the first row that a query returns.
  std::int64_t integer(const std::string& sql);
  const std::string& name() const { return name_; }
  sqlite3* handle() const { return handle_.get(); }
  /// Throws MachineError when the file was moved, replaced or deleted. Called before each
  /// transaction: if another file has replaced this one, SQLite could play back the journal of the
  /// new file into the old file, which is still open.
  void require_in_place() const;
  /// Throws MachineError if the last system call of SQLite failed with EIO. SQLite itself reports
  /// such a read error as a damaged database.
  void require_readable(std::string_view doing) const;
  /// Throws the exception for an SQLite result code. `doing` is the failed operation, e.g. "read".
  [[noreturn]] void fail(int code, std::string_view doing) const;

 private:
  friend class Statement;
  void require_same_file() const;
  /// Throws MachineError if error `code` occurred because a killed program left a journal and this
  /// user has no permission to play the journal back.
  void require_journal_can_be_played_back(int code) const;
  using Prepared = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;
  std::string name_;
  std::string full_name_;  ///< "" for a database in memory
  std::uint64_t device_ = 0, inode_ = 0;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> handle_;
  /// Unused prepared statements, by SQL text. Reuse is faster than preparing a new statement.
  mutable std::unordered_map<std::string, Prepared> idle_;
};

/// A prepared statement; the database must outlive it. Parameters start at 1, columns at 0.
class Statement {
 public:
  /// Binds the values to parameters 1, 2, ...
  template <class... Values>
  Statement(const Database& database, std::string_view sql, const Values&... values)
      : database_(&database), sql_(sql), handle_(prepared()) {
    int parameter = 0;
    (bind(++parameter, values), ...);
  }
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Moves to the next row; returns false after the last row.
  bool step();
  /// Runs a statement that returns no rows.
  void run();

  // Values of the current row. SQLite converts them to the returned type. NULL becomes "" or 0.
  std::string text(int column) const;
  std::uint64_t u64(int column) const;
  double f64(int column) const;
  std::vector<std::byte> blob(int column) const;
  /// Reads columns 0, 1, ... into strings, std::uint64_t and double.
  template <class... Values>
  void get(Values&... values) const {
    int column = 0;
    (get_one(column++, values), ...);
  }
  /// Calls read(row) for each remaining row and returns the results.
  template <class Read>
  auto all(const Read& read) {
    std::vector<std::invoke_result_t<Read, const Statement&>> found;
    while (step()) found.push_back(read(*this));
    return found;
  }
  /// The columns of the current row as "NAME = VALUE", with all digits, for comparing rows.
  std::vector<std::string> cells() const;

 private:
  Database::Prepared prepared() const;
  void check(int code) const;
  void require_fits(std::size_t bytes) const;
  void bind(int parameter, std::string_view text);
  void bind(int parameter, std::uint64_t value);
  void bind(int parameter, double value);
  void bind(int parameter, std::span<const std::byte> blob);
  void get_one(int column, std::string& value) const { value = text(column); }
  void get_one(int column, std::uint64_t& value) const { value = u64(column); }
  void get_one(int column, double& value) const { value = f64(column); }
  const Database* database_;
  std::string sql_;
  Database::Prepared handle_;
};

/// A transaction. The destructor rolls it back unless commit() was called.
class Transaction {
 public:
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 protected:
  /// Runs the SQL statement `begin`. If `nested`, does nothing when another transaction is open.
  Transaction(Database& database, const std::string& begin, bool nested = false);

 private:
  Database& database_;
  bool open_;
};

/// A transaction whose constructor takes the write lock of the database.
struct WriteTransaction : Transaction {
  explicit WriteTransaction(Database& database) : Transaction(database, "BEGIN IMMEDIATE") {}
};

/// All reads within the transaction see the same state of the database. If another transaction is
/// already open, the object does nothing.
struct ReadTransaction : Transaction {
  explicit ReadTransaction(Database& database) : Transaction(database, "BEGIN DEFERRED", true) {}
};

}  // namespace shearcell::sqlite
