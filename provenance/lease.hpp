// SPDX-License-Identifier: GPL-3.0-or-later
// Who works on a run now, so that several programs share one store and none repeats another's work.
//
// A lease is no fact about a result: it is no event, no projection, and means nothing once its
// holder is gone. Losing the table loses nothing, because the log alone decides whose records
// count.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// One program as others can tell it from the next that gets its process id.
struct Holder {
  std::string host;           ///< name, for people
  std::string place;          ///< this boot of the machine and this space of process ids
  std::uint64_t pid = 0;      ///< process id
  std::uint64_t started = 0;  ///< when the process began [clock ticks since boot]
  std::string token;          ///< random, one for each open store
};

struct Lease {
  std::string run;
  Holder holder;
  std::uint64_t attempt = 0;
  std::uint64_t renewed_at_ms = 0;  ///< UTC, milliseconds since 1970
  std::uint64_t expires_at_ms = 0;
};

/// This process, with a fresh token.
Holder this_process();

/// Milliseconds since 1970.
std::uint64_t now_ms();

/// Whether anybody may take the lease: it expired, its holder is known to be dead (asked only of
/// processes of this boot and space of process ids), or it was renewed in the future, as by a clock
/// that has been set back since.
bool lapsed(const Lease& lease, std::uint64_t now);

/// "host vm, process 1234".
std::string describe(const Holder& holder);

/// The table. Stores of schema 1 have none; there nobody holds anything.
void create_leases(sqlite::Database& database);
std::optional<Lease> query_lease(const sqlite::Database& database, std::string_view run);
std::vector<Lease> query_leases(const sqlite::Database& database);
/// Takes the lease over from whoever had it.
void put_lease(sqlite::Database& database, const Lease& lease);
/// Only while the token is still the holder's.
void drop_lease(sqlite::Database& database, std::string_view run, std::string_view token);

}  // namespace shearcell
