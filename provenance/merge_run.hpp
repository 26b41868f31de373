// SPDX-License-Identifier: GPL-3.0-or-later
// Which events of one run another store needs when both have worked on it.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "provenance/event_log.hpp"
#include "provenance/records.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

/// Whether the store lacks the checkpoint, or has only a file of it that was found damaged. The
/// same state in other bytes (another HDF5 library wrote it) is no news.
bool is_news(const sqlite::Database& into, const CheckpointRecord& record);

/// An attempt is taken when it recorded a checkpoint that is news, or when it ended the run in a
/// state that is further than the store's.
struct RunMerge {
  std::optional<RunRecord> before;   ///< the run as the store knew it
  std::optional<Event> last_claim;   ///< the event that gave it that state
  std::set<std::string> known;       ///< checkpoints that were no news
  std::set<std::uint64_t> attempts;  ///< seq, in the source, of the events of attempts to take
  bool source_wins = false;          ///< its state is the further one

  bool wants(const sqlite::Database& into, const Event& event) const;
  /// What restores the store's own state where older events of the source have changed it.
  std::optional<Event> closing_event(const sqlite::Database& into) const;
};

RunMerge plan_run(const sqlite::Database& into, const EventLog& log,
                  const sqlite::Database& source_tables, const std::vector<Event>& source_events,
                  const RunRecord& source_run);

}  // namespace shearcell
