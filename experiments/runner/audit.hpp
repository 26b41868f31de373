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

/// Returns an error for each stage with one of these faults: it started from a wrong state; its id
/// is not the hash of its parameters; its recorded kind, parent, number of grains, seed, swept
/// values or variant does not fit its parameters. Returns a note for each stage with unreadable
/// parameters or a missing parent.
std::vector<Finding> check_runs(const Store& store);

/// All checkpoints, including pruned ones, that this program can recompute bit for bit. Checkpoints
/// from LAMMPS or from a program with another bits_version are excluded, and counted in `left_out`.
/// Order: stage, then step.
std::vector<CheckpointRecord> replayable(const Store& store, std::size_t* left_out = nullptr);

/// A random sample of `count` different records, or all records if there are fewer. Equal seeds
/// give equal samples.
std::vector<CheckpointRecord> sample(std::vector<CheckpointRecord> records, std::size_t count,
                                     std::uint64_t seed);

/// A seed for sample(). Each new event of the log changes the seed.
std::uint64_t seed_of(const Head& head);

struct MeasureCheck {
  std::size_t cached = 0;              ///< number of checkpoints that have cached measures
  std::size_t computed = 0;            ///< number of checkpoints that were measured again
  std::size_t not_covered = 0;         ///< number of pruned checkpoints without digests in the log
  std::size_t absent = 0;              ///< number of uncached measures with a digest in the log
  std::vector<Finding> findings = {};  ///< errors
};

/// Recomputes measures of `count` sampled `records` of `store` and compares them with the ones that
/// are cached in folder/derived.sqlite. `folder` is the folder of `store`, or of another store that
/// was merged into `store`. The relative tolerance is 1e-9, because mathematical libraries differ
/// in the last bits.
MeasureCheck check_sample(const Store& store, const std::filesystem::path& folder,
                          std::vector<CheckpointRecord> records, std::size_t count,
                          std::uint64_t seed);
inline constexpr std::size_t kSampled = 3;  ///< checkpoints that `merge` and `prune` sample

/// check_sample() of all checkpoints. For all pruned checkpoints, also compares the digests of the
/// cached measures with the digests in the log.
MeasureCheck check_measures(const Store& store, std::size_t count, std::uint64_t seed);

/// Calls Store::merge(). Then copies the cached measures of each source, except measures that the
/// log of the source shows to be altered, and except all measures if check_sample() of three
/// checkpoints finds an error. MergeReport::refused lists what was not copied, with the reason.
std::vector<MergeReport> merge_stores(Store& store,
                                      const std::vector<std::filesystem::path>& sources,
                                      const std::set<std::string>& runs = {});

}  // namespace shearcell
