// SPDX-License-Identifier: GPL-3.0-or-later
// Tables derived from the events, for fast queries. They can be dropped and derived again.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/errors.hpp"
#include "provenance/event_log.hpp"
#include "provenance/records.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

/// Derived tables. Schemas 1 and 2 lack the last two tables and some columns of `runs` and
/// `memberships`.
inline constexpr std::array<std::string_view, 6> projected_tables = {
    "runs", "memberships", "checkpoints", "figures", "manifests", "newest"};

/// SQL that creates the empty tables.
extern const char* const projection_tables;
/// Creates empty tables in memory, for the events of a log that may be damaged or forged.
/// `name` is the name of the database in error messages.
sqlite::Database empty_projections(const std::string& name);

/// Applies one event to the tables; no other code writes to them. An event of unknown type changes
/// only updated_at of its run. Throws StoreDamaged when the payload lacks a required member.
void apply(sqlite::Database& database, const Event& event);
/// Applies the event. Then checks that the event has a time, and that a registered manifest or file
/// of grain positions has the recorded SHA-256. Returns a description of what is wrong, or "".
std::string try_apply(sqlite::Database& database, const Event& event);

/// Drops the tables and derives them from the whole log.
void derive_projections(sqlite::Database& database, const EventLog& log,
                        const sqlite::WriteTransaction& lock);
/// Throws StoreDamaged, with a remedy, if an event is missing, if the newest event does not match
/// its hash, or if a table lacks the row of an event. Does not compute the hashes of the other
/// events or compare the values in the rows, so the cost is small. Tables of an older schema are
/// not checked.
void require_complete(const sqlite::Database& database, const EventLog& log);
/// Derives the tables in memory for a connection that only reads. SQL statements then use these
/// tables instead of the stored tables of an older schema. Skips events that cannot be applied.
void shadow_projections(sqlite::Database& database, const EventLog& log);

/// One text for each column: "NAME = VALUE", with all digits of numbers.
using RowCells = std::vector<std::string>;
using TableRows = std::vector<RowCells>;  ///< the rows of a table in ascending order

/// All rows of all tables, so that the tables of two databases can be compared.
std::map<std::string, TableRows> projection_rows(const sqlite::Database& database);

// All queries throw StoreDamaged when a table holds a value that cannot come from an event.

/// Whether `wanted` adds something to the stored stage `known`. It adds nothing if a membership of
/// `known` has the place and the checkpoint interval of `wanted`, and a target at least as large as
/// that of `wanted`. True if `known` is empty.
bool adds_something(const std::optional<Stage>& known, const Membership& wanted);
/// False if the last run declared for `place` is another run, for example one with another packing.
bool holds_place(const sqlite::Database& database, std::string_view run, const Place& place);

/// The stages whose ids begin with `prefix`, in the order in which they were declared.
std::vector<Stage> query_stages(const sqlite::Database& database, std::string_view prefix = "");
std::optional<Stage> query_stage(const sqlite::Database& database, std::string_view id);
/// All checkpoints whose SHA-256 begins with `prefix`, in ascending order of step.
std::vector<CheckpointRecord> query_all_checkpoints(const sqlite::Database& database,
                                                    std::string_view prefix = "");
/// The checkpoints of one run, in ascending order of step.
std::vector<CheckpointRecord> query_checkpoints(const sqlite::Database& database,
                                                std::string_view run);
/// Whether the checkpoint is now recorded as pruned. False if the tables cannot be read.
bool is_pruned_now(const sqlite::Database& database, const CheckpointRecord& record);
std::optional<CheckpointRecord> query_checkpoint(const sqlite::Database& database,
                                                 std::string_view run, std::string_view sha256);
std::vector<FigureRecord> query_figures(const sqlite::Database& database);

}  // namespace shearcell
