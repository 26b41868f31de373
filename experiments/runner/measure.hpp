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

#include "analysis/frame.hpp"
#include "analysis/measures.hpp"
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
  /// First and last cycle. Measures that need a simulation (ComputedFrom::simulation) are computed
  /// only for checkpoints in this range; if empty, for all checkpoints.
  std::optional<std::array<std::uint64_t, 2>> simulated = {};
};

struct MeasureOutcome {
  std::set<std::string> damage;    ///< messages on unreadable checkpoints or measures
  std::set<std::string> pruned;    ///< a message for each pruned checkpoint
  std::set<std::string> measured;  ///< SHA-256 of the checkpoints analysed in this call
  std::set<std::string> earlier;   ///< SHA-256 of the earlier checkpoints that measures used
  std::string cache_trouble;       ///< why results cannot be cached; "" if they can

  MeasureOutcome& operator+=(const MeasureOutcome& more);
};

/// A checkpoint to measure, for an experiment whose checkpoints are `every` cycles apart. An
/// earlier checkpoint at a whole cycle is used only if this cycle is a multiple of `every`.
struct ToMeasure {
  CheckpointMeasures* checkpoint;
  std::uint64_t every = 1;
};

/// Sets the measures of the checkpoints: the results of the providers, and the measures that need
/// only the log (ComputedFrom::record). Sets `lacking` to the providers that gave no result.
/// Results are cached under the checkpoint's recorded SHA-256. If all results of a checkpoint are
/// cached, its file is not read and may be missing. Throws StoreDamaged, with a remedy, if a cached
/// result is invalid, or if a checkpoint is pruned and the cache is not ours or damaged;
/// MachineError if the machine cannot read the cached measures of a pruned checkpoint.
MeasureOutcome measure_checkpoints(const Store& store, std::span<const ToMeasure> checkpoints,
                                   std::span<const std::string> providers,
                                   const MeasureOptions& options);

/// Analyses a stored checkpoint. Throws StoreDamaged, with the checkpoint and the run, if the state
/// cannot be analysed. Such a file is damaged, since this program never records such a state.
Analysis analyse_stored(const CheckpointRecord& record, const Checkpoint& checkpoint);

/// Calls work(0) .. work(count - 1), at most `workers` at once. Collects the messages of
/// StoreDamaged and FilePruned. The first other exception ends the work and is rethrown.
MeasureOutcome read_in_parallel(std::size_t count, std::size_t workers,
                                const std::function<void(std::size_t)>& work,
                                const ReadProgress& progress);

}  // namespace shearcell
