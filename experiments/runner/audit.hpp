// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of a store that need the meaning of parameters and measures; Store::verify checks that its
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

/// An error for each stage whose id is not the hash of its parameters; whose kind, parent, number
/// of grains, seed, swept values or variant contradict the parameters; or that did not start from
/// the last state of its parent. A note for each stage whose parameters this program does not know.
std::vector<Finding> check_runs(const Store& store);

/// Every checkpoint that can be replayed, pruned ones included, in the order of runs and steps.
/// Checkpoints of LAMMPS and of programs with another bits version cannot be replayed.
std::vector<CheckpointRecord> replayable(const Store& store);

/// A random sample of `count` records without repetition, or all records. A seed always gives the
/// same sample.
std::vector<CheckpointRecord> sample(std::vector<CheckpointRecord> records, std::size_t count,
                                     std::uint64_t seed);

/// A seed for sample() that changes with every new event of the log.
std::uint64_t seed_of(const Head& head);

struct MeasureCheck {
  std::size_t cached = 0;       ///< checkpoints of the store with cached measures
  std::size_t computed = 0;     ///< checkpoints whose measures were computed again
  std::size_t not_covered = 0;  ///< checkpoints that an earlier version pruned, without digests
  std::size_t absent = 0;       ///< measures that digests cover and the cache lacks
  std::vector<Finding> findings = {};  ///< errors
};

/// Recomputes the measures that derived.sqlite in `folder` keeps, for `count` sampled checkpoints
/// of the store, and compares them to a relative 1e-9 (mathematical libraries differ in the last
/// bits). Compares the measures of checkpoints that the store in `folder` has pruned with the log.
MeasureCheck check_measures(const Store& store, const std::filesystem::path& folder,
                            std::size_t count, std::uint64_t seed);

/// Store::merge(); then copies the cached measures of the sources. If one of three sampled
/// checkpoints of a source has a wrong measure, or a pruned one has an altered measure, none is
/// copied from this source, and the error is added to `refused`.
std::vector<MergeReport> merge_stores(Store& store,
                                      const std::vector<std::filesystem::path>& sources,
                                      const std::set<std::string>& runs = {},
                                      std::vector<Finding>* refused = nullptr);

}  // namespace shearcell
