// SPDX-License-Identifier: GPL-3.0-or-later
// Which events of one run to copy when both stores have computed it.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "provenance/event_log.hpp"
#include "provenance/records.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

/// Whether the store lacks the checkpoint, or has only a damaged file of it. The same state in
/// other bytes (written by another HDF5 library) is not news.
bool is_news(const sqlite::Database& into, const CheckpointRecord& record);

/// An attempt is copied when it recorded a checkpoint that is news, or when it ended the run in a
/// further state than the store's.
struct RunMerge {
  std::optional<RunRecord> before;   ///< the run in the store before the merge
  std::optional<Event> last_claim;   ///< the event that set its state
  std::set<std::string> known;       ///< checkpoints that are not news
  std::set<std::uint64_t> attempts;  ///< seq, in the source, of the events of attempts to copy
  bool source_wins = false;          ///< the source's state is the further one

  bool wants(const sqlite::Database& into, const Event& event) const;
  /// A copy of `last_claim` when the copied events changed the state of the run; appending it again
  /// restores the store's own state.
  std::optional<Event> closing_event(const sqlite::Database& into) const;
};

RunMerge plan_run(const sqlite::Database& into, const EventLog& log,
                  const sqlite::Database& source_tables, const std::vector<Event>& source_events,
                  const RunRecord& source_run);

}  // namespace shearcell
