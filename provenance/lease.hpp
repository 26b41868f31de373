// SPDX-License-Identifier: GPL-3.0-or-later
// A lease says which program computes a run now, so that several programs can share one store.
//
// Leases are not part of the log. The log alone decides which events are valid, so no event is lost
// if the table of leases is lost.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// Identifies one process, even if another process gets the same process id later.
struct Holder {
  std::string host;           ///< name of the machine, for messages
  std::string place;          ///< boot id and process-id namespace; "" when unknown
  std::uint64_t pid = 0;      ///< process id
  std::uint64_t started = 0;  ///< start time of the process [clock ticks since boot]
  std::string token;          ///< random; different for each Store object
};

struct Lease {
  std::string run;
  Holder holder;
  std::uint64_t attempt = 0;
  std::uint64_t renewed_at_ms = 0;  ///< UTC, milliseconds since 1970
  std::uint64_t expires_at_ms = 0;
};

/// Describes this process, with a new token.
Holder this_process();

/// The longest duration of a lease. An expiry time further in the future comes from a wrong clock
/// or a forged row and is ignored.
inline constexpr std::uint64_t kLongestLeaseMs = 60'000;

/// Whether another program may continue the run. A lease lapses at expires_at_ms, when
/// kLongestLeaseMs has passed since its renewal, or when the process of its holder is dead (this is
/// checked only if Holder::place is the same for the holder and this process). A lease also lapses
/// when the clock was set back to a time before the renewal.
bool lapsed(const Lease& lease, std::uint64_t now);

/// "host vm, process 1234".
std::string describe(const Holder& holder);

/// SQL that creates the table of leases. Stores of schema 1 have no such table and no leases.
extern const char* const lease_table;
/// The leases of one run, or of all runs (""), including those that have lapsed.
std::vector<Lease> query_leases(const sqlite::Database& database, std::string_view run = "");
/// Stores a lease that begins now and lasts `duration_ms`. Replaces any other lease of the run.
void put_lease(sqlite::Database& database, std::string_view run, const Holder& holder,
               std::uint64_t attempt, std::uint64_t duration_ms);
/// Deletes the lease of the run if the lease has this token.
void drop_lease(sqlite::Database& database, std::string_view run, std::string_view token);

}  // namespace shearcell
