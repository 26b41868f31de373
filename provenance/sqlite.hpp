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
  create,  ///< read and write; a missing one is created
  write,   ///< read and write; it must exist
  read     ///< it must exist; functions that write throw std::logic_error
};

}  // namespace shearcell

namespace shearcell::sqlite {

/// The absolute name under which a database is opened. Throws UsageError when it is longer than
/// SQLite's own limit.
std::string full_name(const std::filesystem::path& file);

/// One connection, for one thread at a time. Messages of exceptions name the file. All functions
/// throw StoreDamaged when the file is not a valid database; MachineError when another process kept
/// the file locked, or when the file was moved, replaced or deleted; and std::runtime_error when
/// the machine fails (disk full, no permission).
///
/// The file and SQLite's own files beside it must be regular files without hard links: SQLite finds
/// its journal by the name of the file, so a second name of the file would make it play back a
/// journal of another database, or none.
class Database {
 public:
  /// Even with Access::read SQLite may write: it rolls back the transaction of a crashed program.
  Database(const std::filesystem::path& file, Access access);
  /// Errors name it `name`.
  static Database in_memory(const std::string& name = ":memory:");

  /// Runs statements and ignores their rows.
  void execute(const std::string& sql);
  /// The first column of the first row of a query.
  std::int64_t integer(const std::string& sql);
  const std::string& name() const { return name_; }
  sqlite3* handle() const { return handle_.get(); }
  /// Throws MachineError when the file was moved, replaced or deleted. Called before each
  /// transaction, which may play back a journal.
  void require_in_place() const;
  /// Throws MachineError if the last system call of SQLite failed with EIO. SQLite calls a database
  /// damaged that it cannot read.
  void require_readable(std::string_view doing) const;
  /// Throws the exception for an SQLite result code.
  [[noreturn]] void fail(int code, std::string_view doing) const;

 private:
  friend class Statement;
  void require_same_file() const;
  /// Throws MachineError if the error `code` comes from a journal that a killed program left and
  /// that this user cannot play back.
  void require_journal_can_be_played_back(int code) const;
  using Prepared = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;
  std::string name_;
  std::string full_name_;  ///< "" in memory
  std::uint64_t device_ = 0, inode_ = 0;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> handle_;
  /// Prepared statements that are not in use, by their text: preparing takes longer than running.
  mutable std::unordered_map<std::string, Prepared> idle_;
};

/// A prepared statement; the database must outlive it. Parameters count from 1, columns from 0.
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

  /// Moves to the next row; false when there is none.
  bool step();
  /// Runs a statement that gives no rows.
  void run();

  // The current row. A value of another type is converted as SQLite does; NULL is empty or 0.
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
  /// What read(row) returns for each row that is left.
  template <class Read>
  auto all(const Read& read) {
    std::vector<std::invoke_result_t<Read, const Statement&>> found;
    while (step()) found.push_back(read(*this));
    return found;
  }
  /// The whole row as SQL literals with all digits, to compare rows.
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

/// The destructor rolls the transaction back unless it was committed.
class Transaction {
 public:
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 protected:
  /// Begins nothing if it is `nested` and within another transaction.
  Transaction(Database& database, const std::string& begin, bool nested = false);

 private:
  Database& database_;
  bool open_;
};

/// Takes the write lock when it is constructed.
struct WriteTransaction : Transaction {
  explicit WriteTransaction(Database& database) : Transaction(database, "BEGIN IMMEDIATE") {}
};

/// All reads within the transaction see the same state of the database. Within another transaction
/// it does nothing.
struct ReadTransaction : Transaction {
  explicit ReadTransaction(Database& database) : Transaction(database, "BEGIN DEFERRED", true) {}
};

}  // namespace shearcell::sqlite
