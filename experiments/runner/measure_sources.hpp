// SPDX-License-Identifier: GPL-3.0-or-later
// The checkpoints of a store that a measure is taken from: its own, and earlier ones of its run.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "analysis/derived_measures.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/derived.hpp"
#include "provenance/store.hpp"

namespace shearcell {

class MeasureSources {
 public:
  /// `cadence` is MeasureOptions::cadence.
  explicit MeasureSources(const Store& store, std::map<std::string, std::uint64_t> cadence = {})
      : store_(store), cadence_(std::move(cadence)) {}

  /// Reads the log for find(), measure() and earlier(), unless it has; key() does it where needed.
  void read_run(const std::string& run);

  /// The checkpoint of the same run so many cycles earlier, which the experiment asks for; null if
  /// it does not exist. Call read_run() first. Valid as long as this object.
  const CheckpointRecord* find(const CheckpointRecord& record, std::uint64_t cycles) const;

  /// The key under which a result is cached; it also names the earlier checkpoints that the measure
  /// needs, for which the log is read.
  DerivedKey key(const CheckpointRecord& record, const DerivedMeasure& measure);

  /// The measure of a loaded checkpoint; nothing, and a line in `unread`, if an earlier checkpoint
  /// cannot be read. For a measure that needs earlier checkpoints, call read_run() first. Then any
  /// number of threads may call this.
  std::optional<nlohmann::json> measure(const CheckpointRecord& record,
                                        const Checkpoint& checkpoint, const Analysis& analysis,
                                        const DerivedMeasure& measure,
                                        UnreadCheckpoints& unread) const;

  /// The checkpoint of the same run so many cycles earlier; nothing if it does not exist or cannot
  /// be read. Call read_run() first.
  std::optional<Checkpoint> earlier(const CheckpointRecord& record, std::uint64_t cycles) const;

 private:
  struct Shear {
    std::uint64_t cycle_steps = 0;
    std::map<std::uint64_t, CheckpointRecord> checkpoints = {};  // by step
  };

  Shear read_shear(const std::string& id) const;

  const Store& store_;
  std::map<std::string, std::uint64_t> cadence_;
  std::map<std::string, Shear> runs_;  // by id; empty for a run that does not shear
};

}  // namespace shearcell
