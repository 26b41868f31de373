// SPDX-License-Identifier: GPL-3.0-or-later
// The little of SQLite that the store needs, with lifetimes and errors in C++ terms.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace shearcell::sqlite {

enum class Open { existing, create };

/// One connection, for one thread at a time. Its functions throw StoreDamaged when the file is not
/// a sound database, StoreBusy when another process kept it locked, and std::runtime_error when the
/// machine fails (disk full, no permission); each message names the file.
class Database {
 public:
  Database(const std::filesystem::path& file, Open mode);
  static Database in_memory();

  /// Runs statements that return nothing of interest.
  void execute(const std::string& sql);
  /// The one number that a query gives.
  std::int64_t integer(const std::string& sql);
  const std::string& name() const { return name_; }
  sqlite3* handle() const { return handle_.get(); }
  /// Throws the exception that fits an SQLite result code.
  [[noreturn]] void fail(int code, std::string_view doing) const;

 private:
  friend class Statement;
  Database() = default;
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  struct Finalize {
    void operator()(sqlite3_stmt* handle) const;
  };
  using Prepared = std::unique_ptr<sqlite3_stmt, Finalize>;
  std::string name_;
  std::unique_ptr<sqlite3, Close> handle_;
  /// Statements that are not in use, by their text: preparing one takes longer than running it.
  mutable std::unordered_map<std::string, Prepared> idle_;
};

/// A prepared statement, for less long than its database. Columns are read by position after `step`
/// returned true.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int parameter, std::string_view text);
  Statement& bind(int parameter, std::uint64_t value);
  Statement& bind(int parameter, double value);
  Statement& bind(int parameter, std::span<const std::byte> blob);
  /// NULL when the text is empty.
  Statement& bind_or_null(int parameter, std::string_view text);
  /// Moves to the next row; false when there is none.
  bool step();
  /// Runs a statement that gives no rows and makes it ready to run again.
  void run();
  /// Makes it ready to run again before its last row was read.
  void reset();

  std::string text(int column) const;
  std::uint64_t u64(int column) const;
  double f64(int column) const;
  std::vector<std::byte> blob(int column) const;
  int columns() const;
  /// The value as SQL would write it, to compare rows with.
  std::string literal(int column) const;

 private:
  void check(int code) const;
  const Database* database_;
  std::string sql_;
  Database::Prepared handle_;
};

/// Holds the write lock from its construction (BEGIN IMMEDIATE); undone unless committed.
class WriteTransaction {
 public:
  explicit WriteTransaction(Database& database);
  ~WriteTransaction();
  WriteTransaction(const WriteTransaction&) = delete;
  WriteTransaction& operator=(const WriteTransaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

/// All reads within its life see the same state of the database.
class ReadTransaction {
 public:
  explicit ReadTransaction(Database& database);
  ~ReadTransaction();
  ReadTransaction(const ReadTransaction&) = delete;
  ReadTransaction& operator=(const ReadTransaction&) = delete;

 private:
  Database& database_;
};

}  // namespace shearcell::sqlite
