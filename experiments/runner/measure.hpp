// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of many checkpoints: reads cached measures, computes missing ones in parallel, and
// caches them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/measures.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Called after each item, by one thread at a time; may be empty.
using ReadProgress = std::function<void(std::size_t done, std::size_t total)>;

struct MeasureOptions {
  std::size_t workers = 1;
  ReadProgress report = {};  ///< called as checkpoints are computed
  /// Names of further providers, whose results are computed and cached whenever a checkpoint is
  /// analysed, so that one analysis serves many callers. They must not need earlier checkpoints.
  std::vector<std::string> also = {};
  /// First and last cycle of the checkpoints for which measures are simulated
  /// (ComputedFrom::simulation). Other checkpoints lack these measures.
  std::optional<std::array<std::uint64_t, 2>> simulated = {};
};

struct MeasureOutcome {
  std::set<std::string> damage;    ///< a line for each checkpoint that could not be read
  std::set<std::string> pruned;    ///< a line for each one whose file was pruned
  std::set<std::string> measured;  ///< SHA-256 of the checkpoints that were analysed now
  std::set<std::string> earlier;   ///< SHA-256 of the earlier checkpoints that entered measures
  std::string cache_trouble;       ///< why results cannot be cached; "" if they can

  MeasureOutcome& operator+=(const MeasureOutcome& more);
};

/// A checkpoint of an experiment with a checkpoint after each `every` cycles. Measures over two
/// checkpoints use only checkpoints of this cadence.
struct ToMeasure {
  CheckpointMeasures* checkpoint;
  std::uint64_t every = 1;
};

/// Sets the measures of these providers, and the measures that follow from the log
/// (ComputedFrom::record), and what is lacking. Results are cached under the checkpoint's recorded
/// SHA-256: for a cached result the file is not read and may be missing. Cached and computed
/// results are the same bytes. Throws StoreDamaged, with a remedy, for a cached result that does
/// not match its key.
MeasureOutcome measure_checkpoints(const Store& store, std::span<const ToMeasure> checkpoints,
                                   std::span<const std::string> providers,
                                   const MeasureOptions& options);

/// The analysis of a stored checkpoint. If analyse() throws AnalysisError, throws StoreDamaged,
/// which names checkpoint and run, since this program records no such state.
Analysis analyse_stored(const CheckpointRecord& record, const Checkpoint& checkpoint);

/// Calls work(0) .. work(count - 1), at most `workers` at once. StoreDamaged and FilePruned
/// become lines; the first other exception ends the work and is rethrown.
MeasureOutcome read_in_parallel(std::size_t count, std::size_t workers,
                                const std::function<void(std::size_t)>& work,
                                const ReadProgress& progress);

}  // namespace shearcell
