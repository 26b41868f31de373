// SPDX-License-Identifier: GPL-3.0-or-later
// The file store.sqlite: creation, recognition, migration, durability settings.
#pragma once

#include <filesystem>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// Version of the table layout, stored as user_version.
inline constexpr std::int64_t kSchemaVersion = 2;
/// "shcl" in ASCII: identifies a store.
inline constexpr std::int64_t kApplicationId = 0x7368636c;

/// Opens the log, creates its tables when it is new or empty, and migrates an older schema without
/// changing events. With `read_only` an older schema is not migrated; the file is still opened for
/// writing if possible, so that SQLite can roll back the transaction of a crashed program. Throws
/// StoreDamaged when the file is not a store or has a newer schema.
sqlite::Database open_database(const std::filesystem::path& file, sqlite::Open mode,
                               bool read_only);

}  // namespace shearcell
