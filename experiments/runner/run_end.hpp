// SPDX-License-Identifier: GPL-3.0-or-later
// When a run ends before its last cycle (`until` of a manifest).
//
// The decision depends on the recorded checkpoints alone, so every process that continues a run
// ends it at the same checkpoint. Checkpoints off the cadence of whole cycles (from interruptions
// or `phases`) are ignored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "experiments/runner/asks.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct MeasuredCycle {
  double cycle = 0;
  Measures measures = {};
  std::optional<CheckpointRecord> unread = {};  ///< the checkpoint, if it cannot be measured
};

/// Why the run ends at cycle `now`, that of its last checkpoint: every experiment that shares it
/// has reached the end that it asks for, by `measured`, its checkpoints on the cadence in order.
/// Nothing while the run continues.
/// {"by": "until", "measure", "value", "extra_cycles", "reached_at_cycle", "memberships"}.
/// Throws FilePruned or StoreDamaged, with the remedy, where an unread checkpoint may decide it.
std::optional<nlohmann::json> ended_early(std::span<const RunAsk> asks,
                                          std::span<const MeasuredCycle> measured, double now);

/// The last cycle of the run that counts for the experiment that asks: its number of cycles, or
/// where its `until` ends the run. Another experiment may have continued it; an experiment's
/// figures and tables are the same whatever shares its runs. May measure checkpoints, and keeps the
/// results. If an unread checkpoint may decide it, the recorded end does, or else it throws as
/// ended_early(). Throws StoreDamaged where the run's declarations are not as this program writes
/// them.
double end_for(const Store& store, const RunRecord& run, const RunAsk& ask,
               const MeasureOptions& options);

/// What the last completion of the run records of its end; null where there is none.
nlohmann::json recorded_end(const Store& store, const std::string& run);

/// The reason recorded with the end of a run that is complete before its last cycle; else null.
/// With "cycles_asked" where the run ended later, at the length that another experiment asked for.
nlohmann::json end_of(const Store& store, const RunRecord& run);

/// "crystalline_percent >= 10 at cycle 25 and 15 more cycles"; "" for null.
std::string describe_end(const nlohmann::json& ended);

/// Mean cycle at which runs of the store with this `until` ended by it; empty if there are no such
/// runs.
std::optional<double> expected_end(const Store& store, const Until& until);

/// Measures the checkpoints of one run until every `until` is reached, and keeps the results in the
/// store's derived.sqlite, where figures find them.
class RunEnd {
 public:
  /// Takes the checkpoints up to `step` that are recorded already.
  RunEnd(const Store& store, const RunRecord& run, std::uint64_t step);

  /// A checkpoint that has just been recorded.
  void add(const CheckpointRecord& record);

  /// Why the run ends at its last checkpoint, as ended_early(). Takes into account experiments that
  /// declared the run meanwhile.
  std::optional<nlohmann::json> ended();

 private:
  const Store& store_;
  std::string run_;
  std::uint64_t cadence_;
  std::vector<CheckpointRecord> records_;  ///< on the cadence
  std::size_t next_ = 0;                   ///< in records_: the first that is not in measured_
  std::vector<MeasuredCycle> measured_;
};

}  // namespace shearcell
