// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/lease.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <sstream>
#include <system_error>
#include <utility>

#include "provenance/io/clock.hpp"

namespace shearcell {

const char* const lease_table = R"sql(
CREATE TABLE leases(
  run TEXT PRIMARY KEY,
  host TEXT NOT NULL,
  place TEXT NOT NULL,
  pid INTEGER NOT NULL,
  started INTEGER NOT NULL,
  token TEXT NOT NULL,
  attempt INTEGER NOT NULL,
  renewed_at_ms INTEGER NOT NULL,
  expires_at_ms INTEGER NOT NULL
) STRICT;
)sql";

namespace {

using sqlite::Database;
using sqlite::Statement;

// Small corrections of the clock must not end a lease.
constexpr std::uint64_t kClockSlackMs = 5000;

bool has_table(const Database& database) {
  return Statement(database, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'leases'")
      .step();
}

Lease read_lease(const Statement& row) {
  Lease lease;
  Holder& h = lease.holder;
  row.get(lease.run, h.host, h.place, h.pid, h.started, h.token, lease.attempt, lease.renewed_at_ms,
          lease.expires_at_ms);
  return lease;
}

/// Boot id and process-id namespace. A process id is valid only within this boot and namespace.
std::string this_place() {
  std::string boot;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id") >> std::ws, boot);
  std::error_code missing;
  const std::string space = std::filesystem::read_symlink("/proc/self/ns/pid", missing);
  if (boot.empty() || missing) return {};  // without /proc, processes cannot be checked
  return boot + " " + space;
}

/// Start time of a process [clock ticks since boot], or 0 for a zombie (ended, but not yet reaped).
/// Returns nothing when /proc does not show the process: it has ended or is hidden (hidepid).
std::optional<std::uint64_t> start_of(std::uint64_t pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  // The second field is the program's name in parentheses and may contain any character, also ')'.
  // So the third field begins after the last ')' of the line.
  std::istringstream rest(line.substr(line.rfind(')') + 1));
  const std::vector<std::string> fields(std::istream_iterator<std::string>(rest), {});
  constexpr std::size_t kState = 0, kStart = 19;  // indices of fields 3 and 22 of the line
  if (fields.size() <= kStart) return std::nullopt;
  if (fields[kState] == "Z" || fields[kState] == "X") return 0;
  return std::stoull(fields[kStart]);
}

bool known_dead(const Holder& holder) {
  if (holder.place.empty() || holder.place != this_place()) return false;
  if (const auto started = start_of(holder.pid)) return *started != holder.started;
  if (holder.pid == 0 || !std::in_range<pid_t>(holder.pid)) return true;
  return kill(static_cast<pid_t>(holder.pid), 0) != 0 && errno == ESRCH;
}

}  // namespace

Holder this_process() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) name[0] = '\0';
  std::random_device random;
  Holder holder{.host = name.data(),
                .place = this_place(),
                .pid = static_cast<std::uint64_t>(getpid()),
                .started = 0,
                .token = {}};
  for (int word = 0; word < 4; ++word) holder.token += fmt::format("{:08x}", random());
  const auto started = start_of(holder.pid);
  holder.started = started.value_or(0);
  if (!started) holder.place.clear();
  return holder;
}

bool lapsed(const Lease& lease, std::uint64_t now) {
  return now >= lease.expires_at_ms || lease.renewed_at_ms > now + kClockSlackMs ||
         now >= lease.renewed_at_ms + kLongestLeaseMs || known_dead(lease.holder);
}

std::string describe(const Holder& holder) {
  return fmt::format("host {}, process {}", holder.host, holder.pid);
}

std::vector<Lease> query_leases(const Database& database, std::string_view run) {
  if (!has_table(database)) return {};
  return Statement(database, "SELECT * FROM leases WHERE ?1 IN ('', run) ORDER BY run", run)
      .all(read_lease);
}

void put_lease(Database& database, std::string_view run, const Holder& h, std::uint64_t attempt,
               std::uint64_t duration_ms) {
  const std::uint64_t now = now_ms();
  Statement(database, "INSERT OR REPLACE INTO leases VALUES(?,?,?,?,?,?,?,?,?)", run, h.host,
            h.place, h.pid, h.started, h.token, attempt, now, now + duration_ms)
      .run();
}

void drop_lease(Database& database, std::string_view run, std::string_view token) {
  Statement(database, "DELETE FROM leases WHERE run = ? AND token = ?", run, token).run();
}

}  // namespace shearcell
