// SPDX-License-Identifier: GPL-3.0-or-later
// Folds the events and checkpoints of other stores into one.
//
// Both logs are sets of facts about the same runs, so merging is a union: an event that the store
// has already (equal stream, type, layout, time and payload) is passed over, and so is a checkpoint
// that it has, with whatever led to nothing but such checkpoints. What is taken keeps its time and
// payload, and gets a new place in the chain. Merging twice changes nothing. The furthest state of
// a run wins: completed before interrupted, a later step before an earlier one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "provenance/event_log.hpp"
#include "provenance/objects.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

struct MergeReport {
  std::string source;             ///< folder, as it was named
  Head head;                      ///< of the source when it was read
  std::uint64_t events = 0;       ///< that were taken
  std::uint64_t checkpoints = 0;  ///< whose files were copied
  std::uint64_t bytes = 0;        ///< of these files
};

/// One snapshot of a store to merge from, found sound: chain and events. Reading does not change
/// it, nor its schema.
struct MergeSource {
  std::filesystem::path folder;
  Head head;
  std::vector<Event> events;
  std::unique_ptr<sqlite::Database> tables;  ///< derived from the events alone, in memory
  ObjectStore objects;
};

/// With `runs`, of these runs and the manifests only. Throws NotFound when there is no store and
/// StoreDamaged when its chain does not hold.
MergeSource read_merge_source(const std::filesystem::path& folder,
                              const std::set<std::string>& runs = {});

/// Throws MergeConflict, naming both stores, when two of them hold different states of the same run
/// at the same step, or different runs under one id.
void require_agreement(const sqlite::Database& into, const std::string& name,
                       const std::vector<MergeSource>& sources);

/// Reads and hashes every file that `copy_objects` would copy. Throws StoreDamaged.
void check_objects(const sqlite::Database& into, const MergeSource& source);

/// Puts the files there that the source has and the store's records lack.
void copy_objects(const sqlite::Database& into, ObjectStore& objects, const MergeSource& source,
                  MergeReport& report);

/// Appends the source's news and StoreMerged, and applies them; the files must be there.
void merge_events(sqlite::Database& into, EventLog& log, const sqlite::WriteTransaction& lock,
                  const MergeSource& source, MergeReport& report);

}  // namespace shearcell
