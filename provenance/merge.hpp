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

/// Merges the stores in `sources` into the one in `folder`, whose database, log and objects are
/// given; if `runs` is not empty, only these runs and the manifests. Throws NotFound when there is
/// no store, MachineError while a program computes a run of `folder`, and StoreDamaged, before
/// anything is written, when a source is damaged, or when two stores hold different states of the
/// same run at the same step or different runs under one id.
std::vector<MergeReport> merge_stores(sqlite::Database& into, EventLog& log, ObjectStore& objects,
                                      const std::filesystem::path& folder,
                                      const std::vector<std::filesystem::path>& sources,
                                      const std::set<std::string>& runs);

}  // namespace shearcell
