// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs of the measures of a store's checkpoints: the checkpoint, earlier checkpoints of its run,
// and the run.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "analysis/measures.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/derived.hpp"
#include "provenance/store.hpp"

namespace shearcell {

class MeasureSources {
 public:
  explicit MeasureSources(const Store& store) : store_(&store) {}
  /// For one run, called `id`, without its earlier checkpoints.
  MeasureSources(const std::string& id, const Stage& stage);

  /// Reads the log of a run, once. Call this before the other functions take a checkpoint of the
  /// run; any number of threads may then call them.
  void read_run(const std::string& run);

  /// The earlier checkpoint of the same run that the provider needs; null if an experiment with a
  /// checkpoint after each `every` cycles has none there. Valid as long as this object.
  const CheckpointRecord* earlier(const CheckpointRecord& record, const Provider& provider,
                                  std::uint64_t every) const;

  /// The key under which a result is cached; it also names the earlier checkpoint that the provider
  /// needs.
  DerivedKey key(const CheckpointRecord& record, const Provider& provider,
                 std::uint64_t every) const;

  /// Whether a cached object has the digest that the log recorded when the checkpoint's file was
  /// pruned; nothing if the log does not name the object. True if the log has no digests of the
  /// checkpoint.
  std::optional<bool> is_as_pruned(const CheckpointRecord& record,
                                   const DerivedObject& object) const;

  struct PrunedMeasures {
    std::size_t named = 0, absent = 0;  ///< in the log; and not in the cache
    std::string altered;                ///< names one that differs from the log; "" if none does
  };
  /// Compares what is cached of a checkpoint that is pruned now with the log.
  PrunedMeasures compare_pruned(const CheckpointRecord& record, DerivedCache& cache) const;

  /// Cycles between the checkpoints that experiments ask for, and 1.
  const std::set<std::uint64_t>& cadences(const std::string& run) const {
    return runs_.at(run).cadences;
  }
  const RunFacts& facts(const std::string& run) const { return runs_.at(run).facts; }
  Checkpoint load(const CheckpointRecord& record) const { return store_->load_checkpoint(record); }

  /// The provider's result; nothing, and a line in `unread`, if an earlier checkpoint cannot be
  /// read. `checkpoint` may be null if the provider needs only the record.
  std::optional<nlohmann::json> compute(const Provider& provider, const CheckpointRecord& record,
                                        std::uint64_t every, const Checkpoint* checkpoint,
                                        const Analysis* analysis, MeasureOutcome& unread) const;

  /// Adds the measures that follow from the log.
  void add_recorded(const CheckpointRecord& record, Measures& measures) const;

  /// The measures of a loaded checkpoint by these providers, and the measures that follow from the
  /// log. Measures whose earlier checkpoint cannot be read are left out, with a line in `unread`.
  Measures measures_of(const CheckpointRecord& record, std::uint64_t every,
                       const Checkpoint& checkpoint, const Analysis& analysis,
                       bool (*wanted)(const Provider&), MeasureOutcome& unread) const;

 private:
  struct Run {
    RunFacts facts = {};
    std::set<std::uint64_t> cadences = {1};
    std::map<std::uint64_t, CheckpointRecord> checkpoints = {};  // of a shear, by step
    std::map<std::string, Digests> digests = {};                 // by SHA-256
  };

  const Store* store_ = nullptr;
  std::map<std::string, Run> runs_;  // by id
};

}  // namespace shearcell
