// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of many checkpoints: reads the cached ones, computes the others, several at a time, and
// caches them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "analysis/derived_measures.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Called after each item, by one thread at a time; may be empty.
using ReadProgress = std::function<void(std::size_t done, std::size_t total)>;

struct MeasureOptions {
  std::size_t workers = 1;
  bool fresh = false;   ///< compute all of them again and replace the cached ones
  ReadProgress report;  ///< called as checkpoints are computed
  /// If given, computes the only measure instead of an analysis.
  std::function<nlohmann::json(const CheckpointRecord& record, const Checkpoint& checkpoint)>
      instead = {};
  /// Cycles between the checkpoints that the experiment asks of a run, by its id; 1 for others.
  /// Measures over two checkpoints do not use those that interruptions and other experiments left.
  std::map<std::string, std::uint64_t> cadence = {};
  /// Names of further measures, which are cached too whenever a checkpoint is analysed (not with
  /// `fresh`), so that one analysis serves many callers. None may need earlier checkpoints.
  std::vector<std::string> also = {};
};

/// A line for each checkpoint that could not be read; sorted.
struct UnreadCheckpoints {
  std::vector<std::string> damage;
  std::vector<std::string> pruned;  ///< whose files were pruned
};

struct MeasureOutcome : UnreadCheckpoints {
  std::size_t measured = 0;  ///< checkpoints that were analysed now
  std::size_t cached = 0;    ///< checkpoints whose results were in the cache
  /// With `fresh`: checkpoints whose cached results were different.
  std::vector<std::string> changed;
  /// SHA-256 of the earlier checkpoints that measures were taken from too, by run and step.
  std::map<std::string, std::map<std::uint64_t, std::string>> earlier;
  std::string cache_trouble;  ///< why results cannot be cached; "" if they can
};

struct MeasuredCheckpoints : MeasureOutcome {
  /// In the order of the records; for each, results in the order of the measures. A result is null
  /// if the checkpoint, or an earlier one that it needs, could not be read.
  std::vector<std::vector<nlohmann::json>> results;
};

/// Results are cached under the checkpoint's recorded SHA-256, so for a cached result the file is
/// not read and may be missing; `verify` checks files. Cached and computed results are the same
/// bytes.
MeasuredCheckpoints measure_checkpoints(const Store& store,
                                        std::span<const CheckpointRecord> records,
                                        std::span<const DerivedMeasure> measures,
                                        const MeasureOptions& options);

/// The analysis of a stored checkpoint. Throws StoreDamaged, which names the checkpoint and its
/// run, if analyse() throws AnalysisError: this program records no such state.
Analysis analyse_stored(const CheckpointRecord& record, const Checkpoint& checkpoint);

/// All results of one checkpoint, each read by its measure. Throws AnalysisError, with a remedy,
/// for a result that is not what its key says.
Measures read_results(std::span<const DerivedMeasure> measures,
                      std::span<const nlohmann::json> results);

/// SI units of the mechanics of a checkpoint, from the run's resolved parameters; the spring
/// constant is the checkpoint's own if it records one (stiffening). NaN for what the store lacks.
MechanicalUnits mechanical_units(const RunRecord& run, const CheckpointRecord& checkpoint);

/// Adds lines; `all` stays sorted and without repetitions.
void add_unread(const UnreadCheckpoints& more, UnreadCheckpoints& all);

/// Calls work(0) .. work(count - 1), at most `workers` at once. StoreDamaged and FilePruned
/// become lines; the first other exception ends the work and is rethrown.
UnreadCheckpoints read_in_parallel(std::size_t count, std::size_t workers,
                                   const std::function<void(std::size_t)>& work,
                                   const ReadProgress& progress);

}  // namespace shearcell
