// SPDX-License-Identifier: GPL-3.0-or-later
// Tables derived from the events, for quick answers. Every row can be dropped and derived again.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "provenance/event_log.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

/// Makes the empty tables runs, memberships, checkpoints and figures.
void create_projections(sqlite::Database& database);

/// What one event changes in the tables; the only code that writes to them. Events of unknown type
/// change nothing. Throws StoreDamaged when a payload does not hold what its type must.
void apply(sqlite::Database& database, const Event& event);

/// Drops the tables and derives them from the whole log, all or nothing.
void rebuild_projections(sqlite::Database& database, const EventLog& log);

/// Every row of every table as text, to compare two derivations.
std::map<std::string, std::vector<std::string>> projection_rows(const sqlite::Database& database);

}  // namespace shearcell
