// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of a store that need the meaning of parameters and measures. Store::verify() checks that
// events, files and tables agree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "provenance/store.hpp"

namespace shearcell {

/// Returns an error for each stage whose id is not the hash of its parameters; whose kind, parent,
/// number of grains, seed, swept values or variant contradict the parameters; or that started from
/// a wrong state of its parent. Returns a note for each stage with parameters of another version.
std::vector<Finding> check_runs(const Store& store);

/// Every checkpoint that can be replayed, including pruned ones, in the order of runs and steps.
/// Checkpoints from LAMMPS and from programs with another bits version cannot be replayed.
std::vector<CheckpointRecord> replayable(const Store& store);

/// A random sample of `count` different records, or all records if there are fewer. The same seed
/// gives the same sample.
std::vector<CheckpointRecord> sample(std::vector<CheckpointRecord> records, std::size_t count,
                                     std::uint64_t seed);

/// A seed for sample() that changes with every new event of the log.
std::uint64_t seed_of(const Head& head);

struct MeasureCheck {
  std::size_t cached = 0;              ///< checkpoints of the store with cached measures
  std::size_t computed = 0;            ///< checkpoints whose measures were computed again
  std::size_t not_covered = 0;         ///< pruned checkpoints without digests in the log
  std::size_t absent = 0;              ///< measures with a digest in the log that are not cached
  std::vector<Finding> findings = {};  ///< errors
};

/// Recomputes the measures that derived.sqlite in `folder` has, for `count` sampled checkpoints of
/// `store`. They must agree to a relative 1e-9, because mathematical libraries differ in the last
/// bits. Compares the cached measures of pruned checkpoints of the store in `folder` with its log.
MeasureCheck check_measures(const Store& store, const std::filesystem::path& folder,
                            std::size_t count, std::uint64_t seed);

/// Calls Store::merge(), then copies the cached measures of the sources. Copies no measures from a
/// source if one of three sampled checkpoints has a wrong measure, or a pruned checkpoint has an
/// altered measure. Adds the error to `refused`.
std::vector<MergeReport> merge_stores(Store& store,
                                      const std::vector<std::filesystem::path>& sources,
                                      const std::set<std::string>& runs = {},
                                      std::vector<Finding>* refused = nullptr);

}  // namespace shearcell
