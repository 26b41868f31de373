// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of stored checkpoints: reads cached measures, computes missing ones in parallel, and
// caches them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "analysis/frame.hpp"
#include "analysis/measures.hpp"
#include "provenance/derived.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Called with the progress after each item, by one thread at a time. May be empty.
using ReadProgress = std::function<void(std::size_t done, std::size_t total)>;

struct MeasureOptions {
  std::size_t workers = 1;
  ReadProgress report = {};  ///< called after each measured checkpoint
  /// Names of further providers. Whenever a checkpoint is analysed, their results are also computed
  /// and cached for later calls. These providers must not need earlier checkpoints.
  std::vector<std::string> also = {};
  /// First and last cycle of a range. Measures that need a simulation (ComputedFrom::simulation)
  /// are computed only for checkpoints in this range. Without a range, they are computed for all
  /// checkpoints.
  std::optional<std::array<std::uint64_t, 2>> simulated = {};
  bool only_cached = false;  ///< read no checkpoint; results that are not cached are missing
};

struct MeasureOutcome {
  std::set<std::string> damage;    ///< messages on unreadable checkpoints or measures
  std::set<std::string> pruned;    ///< a message for each pruned checkpoint
  std::set<std::string> measured;  ///< SHA-256 of the checkpoints analysed in this call
  std::set<std::string> earlier;   ///< SHA-256 of the earlier checkpoints that measures need
  std::string cache_trouble;       ///< why results cannot be cached; "" if they can

  MeasureOutcome& operator+=(const MeasureOutcome& more);
};

/// A checkpoint to measure, for an experiment whose checkpoints are `every` cycles apart. Some
/// measures also need an earlier checkpoint of the run. If the earlier checkpoint is at a whole
/// cycle, it is used only if this cycle is a multiple of `every`.
struct ToMeasure {
  CheckpointMeasures* checkpoint;
  std::uint64_t every = 1;
};

/// Sets the measures of the checkpoints: the results of the providers, and the measures that need
/// only the log (ComputedFrom::record). Sets `lacking` to the providers that gave no result.
/// Results are cached under the checkpoint's recorded SHA-256. If all results of a checkpoint are
/// cached, its file is not read and may be missing. Throws StoreDamaged, with a remedy, if a cached
/// result is invalid. For a pruned checkpoint, also throws StoreDamaged if the cache is damaged or
/// is another program's database, and MachineError if the machine cannot read the cache.
MeasureOutcome measure_checkpoints(const Store& store, std::span<const ToMeasure> checkpoints,
                                   std::span<const std::string> providers,
                                   const MeasureOptions& options);

/// Analyses a stored checkpoint. If the state cannot be analysed, throws StoreDamaged, which names
/// the checkpoint and the run. This program records no such state, so the file must be damaged.
Analysis analyse_stored(const CheckpointRecord& record, const Checkpoint& checkpoint);

/// Calls work(0) .. work(count - 1), at most `workers` at once. Collects the messages of
/// StoreDamaged and FilePruned. Any other exception ends the work and is rethrown.
MeasureOutcome read_in_parallel(std::size_t count, std::size_t workers,
                                const std::function<void(std::size_t)>& work,
                                const ReadProgress& progress);

/// The data from which the measures of a stored checkpoint are computed: the checkpoint, earlier
/// checkpoints of the same run, and facts of the run.
class MeasureSources {
 public:
  explicit MeasureSources(const Store& store) : store_(&store) {}

  /// Reads the log of a run, unless it has been read. Call this before you pass a checkpoint of the
  /// run to another function. After that, any number of threads may call the other functions.
  void read_run(const std::string& run);

  /// The earlier checkpoint of the same run that the provider needs. Null if it was never recorded,
  /// or if its cycle is whole but not a multiple of `every`. Valid while this object exists.
  const CheckpointRecord* earlier(const CheckpointRecord& record, const Provider& provider,
                                  std::uint64_t every) const;

  /// The key under which a result is cached. If the provider needs an earlier checkpoint, the key
  /// includes the SHA-256 of that checkpoint.
  DerivedKey key(const CheckpointRecord& record, const Provider& provider,
                 std::uint64_t every) const;

  /// Whether a cached object has the digest that was logged when the checkpoint was pruned. True if
  /// the log has no digests for this checkpoint, or if its run was not read. Empty if the log has
  /// digests for this checkpoint but no digest for this object.
  std::optional<bool> is_as_pruned(const CheckpointRecord& record,
                                   const DerivedObject& object) const;

  struct PrunedMeasures {
    /// `named`: number of measures with a digest in the log. `absent`: how many of them are not
    /// cached.
    std::size_t named = 0, absent = 0;
    /// Error message if the digest of a cached measure is not the logged digest; otherwise "".
    std::string altered;
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

  /// The results of all providers for which `wanted` is true, and of all providers that need only
  /// the log (ComputedFrom::record). `checkpoint` and `analysis` may be null if `wanted` is false
  /// for all providers. If an earlier checkpoint cannot be read, leaves out the measures that need
  /// it and adds the reason to `unread`.
  Measures measures_of(const CheckpointRecord& record, std::uint64_t every,
                       const Checkpoint* checkpoint, const Analysis* analysis,
                       bool (*wanted)(const Provider&), MeasureOutcome& unread) const;

 private:
  struct Run {
    RunFacts facts = {};
    std::set<std::uint64_t> cadences = {1};
    std::map<std::uint64_t, CheckpointRecord> checkpoints = {};  // by step; only of shear stages
    std::map<std::string, Digests> digests = {};                 // by SHA-256 of the checkpoint
  };

  const Store* store_;
  std::map<std::string, Run> runs_;  // by id
};

}  // namespace shearcell
