// SPDX-License-Identifier: GPL-3.0-or-later
// The file store.sqlite: how it is recognized, made, and protected from half-written states.
#pragma once

#include <filesystem>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// Layout of the tables that this program writes, kept in the file's user_version.
inline constexpr std::int64_t kSchemaVersion = 2;
/// "shcl" in ASCII: tells a store from any other SQLite file.
inline constexpr std::int64_t kApplicationId = 0x7368636c;

/// Opens the log's file, makes its tables when it is new or empty, and brings an older schema up to
/// date; the events stay as they are. A read-only connection leaves an older schema alone. It still
/// opens the file for writing where it may, because SQLite then undoes a transaction that a crash
/// cut short. Throws StoreDamaged when the file is no store or has a newer schema.
sqlite::Database open_database(const std::filesystem::path& file, sqlite::Open mode,
                               bool read_only);

}  // namespace shearcell
