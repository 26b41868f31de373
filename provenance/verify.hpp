// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the store still is what was written: chain, objects, projections.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "provenance/event_log.hpp"
#include "provenance/objects.hpp"

namespace shearcell {

struct Finding {
  /// An error means that something recorded is lost or changed; a note does not.
  enum class Severity { note, error };
  Severity severity = Severity::note;
  std::string subject;  ///< file, event or table that it is about
  std::string run;      ///< the run that it touches, or ""
  std::string message;  ///< what is wrong and what to do
};

struct VerifyReport {
  std::vector<Finding> findings;
  std::uint64_t events = 0;
  std::uint64_t checkpoints = 0;  ///< whose bytes were hashed
  std::uint64_t bytes = 0;        ///< that were hashed
  std::uint64_t orphans = 0;      ///< files that no event names
  Head head;                      ///< keep it elsewhere to prove later that the log only grew

  /// No error was found.
  bool ok() const;
};

/// Damage becomes findings; the rest is still examined. With `against`, a head that was told
/// earlier, a log that does not extend it is damaged as well. Throws only when the machine fails.
VerifyReport verify(sqlite::Database& database, const EventLog& log, const ObjectStore& objects,
                    const std::optional<Head>& against = std::nullopt);

}  // namespace shearcell
