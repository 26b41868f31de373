// SPDX-License-Identifier: GPL-3.0-or-later
// Verification of a store: chain, objects, projections.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "provenance/checkpoint.hpp"
#include "provenance/event_log.hpp"
#include "provenance/objects.hpp"
#include "provenance/records.hpp"

namespace shearcell {

struct Finding {
  /// An error: a record is lost or changed. A note: everything recorded is intact.
  enum class Severity { note, error };
  Severity severity = Severity::note;
  std::string subject;  ///< file, event or table
  std::string run;      ///< affected run, or ""
  std::string message;  ///< problem and remedy
};

struct VerifyReport {
  std::vector<Finding> findings;
  std::uint64_t events = 0;
  std::uint64_t checkpoints = 0;  ///< number of checkpoint files hashed
  std::uint64_t bytes = 0;        ///< size of these files
  std::uint64_t orphans = 0;      ///< files that no event names
  Head head;                      ///< kept elsewhere, it proves later that the log only grew

  /// Without errors.
  bool ok() const;
};

/// Decodes the file of a record of this run. Throws StoreDamaged also when it is not plausible, or
/// when its run, step, cycle, time, units, number of grains, observables or state are not those
/// that the record and the run's parameters say.
Checkpoint read_checkpoint(std::span<const std::byte> image, const CheckpointRecord& record,
                           const RunRecord& run);

/// Damage is reported as findings, and the check continues. With `against`, a head of earlier, a
/// log that does not extend it is damaged. Throws only when the machine fails.
VerifyReport verify(sqlite::Database& database, const EventLog& log, const ObjectStore& objects,
                    const std::optional<Head>& against = std::nullopt);

}  // namespace shearcell
