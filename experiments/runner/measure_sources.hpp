// SPDX-License-Identifier: GPL-3.0-or-later
// The data from which the measures of a stored checkpoint are computed: the checkpoint, earlier
// checkpoints of the same run, and facts of the run.
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
  /// Sources for one run with this id, without a store. Earlier checkpoints are not available.
  MeasureSources(const std::string& id, const Stage& stage);

  /// Reads the log of a run, unless it has been read. Call this before you pass a checkpoint of the
  /// run to another function. After that, any number of threads may call the other functions.
  void read_run(const std::string& run);

  /// The earlier checkpoint of the same run that the provider needs. Null if it was never recorded,
  /// or if it is at a whole cycle that `every` does not divide. Valid while this object exists.
  const CheckpointRecord* earlier(const CheckpointRecord& record, const Provider& provider,
                                  std::uint64_t every) const;

  /// The key under which a result is cached. If the provider needs an earlier checkpoint, the key
  /// includes the SHA-256 of that checkpoint.
  DerivedKey key(const CheckpointRecord& record, const Provider& provider,
                 std::uint64_t every) const;

  /// Whether a cached object has the digest that was logged when the checkpoint was pruned. True if
  /// the log has no digests for this checkpoint. Empty if the log has digests for this checkpoint
  /// but no digest for this object.
  std::optional<bool> is_as_pruned(const CheckpointRecord& record,
                                   const DerivedObject& object) const;

  struct PrunedMeasures {
    std::size_t named = 0, absent = 0;  ///< digests in the log; digests of uncached measures
    std::string altered;  ///< message about a measure that differs from the log, or ""
  };
  /// Compares the cached measures of a pruned checkpoint with the digests in the log.
  PrunedMeasures compare_pruned(const CheckpointRecord& record, DerivedCache& cache) const;

  /// Checkpoint intervals [cycles] of the experiments that use the run; 1 is always included.
  const std::set<std::uint64_t>& cadences(const std::string& run) const {
    return runs_.at(run).cadences;
  }
  const RunFacts& facts(const std::string& run) const { return runs_.at(run).facts; }
  Checkpoint load(const CheckpointRecord& record) const { return store_->load_checkpoint(record); }

  /// The provider's result. Empty if an earlier checkpoint cannot be read; the reason is added to
  /// `unread`. `checkpoint` may be null if the provider needs only the record.
  std::optional<nlohmann::json> compute(const Provider& provider, const CheckpointRecord& record,
                                        std::uint64_t every, const Checkpoint* checkpoint,
                                        const Analysis* analysis, MeasureOutcome& unread) const;

  /// Adds the measures that need only the log (ComputedFrom::record).
  void add_recorded(const CheckpointRecord& record, Measures& measures) const;

  /// The measures of a loaded checkpoint: the results of all providers for which `wanted` is true,
  /// and the measures that need only the log. If an earlier checkpoint cannot be read, leaves out
  /// the measures that need it and adds the reason to `unread`.
  Measures measures_of(const CheckpointRecord& record, std::uint64_t every,
                       const Checkpoint& checkpoint, const Analysis& analysis,
                       bool (*wanted)(const Provider&), MeasureOutcome& unread) const;

 private:
  struct Run {
    RunFacts facts = {};
    std::set<std::uint64_t> cadences = {1};
    std::map<std::uint64_t, CheckpointRecord> checkpoints = {};  // by step; filled only for a shear
    std::map<std::string, Digests> digests = {};                 // by SHA-256 of the checkpoint
  };

  const Store* store_ = nullptr;
  std::map<std::string, Run> runs_;  // by id
};

}  // namespace shearcell
