// SPDX-License-Identifier: GPL-3.0-or-later
// Tables derived from the events, for fast queries. They can be dropped and derived again.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "provenance/event_log.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

/// Creates the empty tables runs, memberships, checkpoints and figures.
void create_projections(sqlite::Database& database);

/// Applies one event to the tables; no other code writes to them. Events of unknown type change
/// nothing. Throws StoreDamaged when the payload lacks what its type requires.
void apply(sqlite::Database& database, const Event& event);

/// Drops the tables and derives them from the whole log in one transaction.
void rebuild_projections(sqlite::Database& database, const EventLog& log);

/// Every row of every table as text, to compare two derivations.
std::map<std::string, std::vector<std::string>> projection_rows(const sqlite::Database& database);

}  // namespace shearcell
