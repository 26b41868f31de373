// SPDX-License-Identifier: GPL-3.0-or-later
// Merges the events and checkpoints of other stores into one.
//
// The result is the union: events that the store already has (equal stream, type, layout, time and
// payload) and checkpoints that it already has are skipped, and so are attempts that recorded
// nothing else. Copied events keep time and payload and get a new place in the chain. The furthest
// state of a run wins: a later step first, then completed before failed, interrupted, running,
// declared. Merging the same store again changes nothing.
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
  std::string source;             ///< folder, as given
  Head head;                      ///< of the source when it was read
  std::uint64_t events = 0;       ///< number of copied events
  std::uint64_t checkpoints = 0;  ///< number of copied files
  std::uint64_t bytes = 0;        ///< size of these files
};

/// A snapshot of a store to merge from, whose chain and events were checked. The store itself is
/// not changed.
struct MergeSource {
  std::filesystem::path folder;
  Head head;
  std::vector<Event> events;
  std::unique_ptr<sqlite::Database> tables;  ///< derived from the events alone, in memory
  ObjectStore objects;
};

/// If `runs` is not empty, only these runs and the manifests. Throws NotFound when there is no
/// store and StoreDamaged when its chain does not hold.
MergeSource read_merge_source(const std::filesystem::path& folder,
                              const std::set<std::string>& runs = {});

/// Throws MergeConflict, naming both stores, when two of them hold different states of the same run
/// at the same step, or different runs under one id.
void require_agreement(const sqlite::Database& into, const std::string& name,
                       const std::vector<MergeSource>& sources);

/// Reads and hashes every file that `copy_objects` would copy. Throws StoreDamaged.
void check_objects(const sqlite::Database& into, const MergeSource& source);

/// Copies the files of checkpoints that the store lacks.
void copy_objects(const sqlite::Database& into, ObjectStore& objects, const MergeSource& source,
                  MergeReport& report);

/// Appends the events that the store lacks, then StoreMerged, and applies them. The files must have
/// been copied.
void merge_events(sqlite::Database& into, EventLog& log, const sqlite::WriteTransaction& lock,
                  const MergeSource& source, MergeReport& report);

}  // namespace shearcell
