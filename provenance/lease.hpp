// SPDX-License-Identifier: GPL-3.0-or-later
// Leases: which program computes a run now, so that several programs can share one store.
//
// Leases are not part of the record: the log alone decides which events count, and losing the table
// loses nothing.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// Identifies one process, even after another process got its process id.
struct Holder {
  std::string host;           ///< name, for messages
  std::string place;          ///< boot id and process-id namespace; "" when unknown
  std::uint64_t pid = 0;      ///< process id
  std::uint64_t started = 0;  ///< start time of the process [clock ticks since boot]
  std::string token;          ///< random, one for each open store
};

struct Lease {
  std::string run;
  Holder holder;
  std::uint64_t attempt = 0;
  std::uint64_t renewed_at_ms = 0;  ///< UTC, milliseconds since 1970
  std::uint64_t expires_at_ms = 0;
};

/// This process, with a new token.
Holder this_process();

/// The longest lease. A later end comes from a wrong clock or a forged row and is ignored.
inline constexpr std::uint64_t kLongestLeaseMs = 60'000;

/// Whether any program may take the lease. The lease lapses when it has expired, when it is older
/// than kLongestLeaseMs, when its holder is dead (checked only for processes of the same boot and
/// namespace), or when its time of renewal is in the future because the clock was set back.
bool lapsed(const Lease& lease, std::uint64_t now);

/// "host vm, process 1234".
std::string describe(const Holder& holder);

/// Creates the table. Stores of schema 1 have no table and no leases.
void create_leases(sqlite::Database& database);
/// The leases of one run, or of all (""), also lapsed ones.
std::vector<Lease> query_leases(const sqlite::Database& database, std::string_view run = "");
/// Writes the lease in place of the lease of any other holder.
void put_lease(sqlite::Database& database, const Lease& lease);
/// Deletes the lease if it still has this token.
void drop_lease(sqlite::Database& database, std::string_view run, std::string_view token);

}  // namespace shearcell
