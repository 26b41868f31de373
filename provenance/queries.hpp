// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the projections into plain records.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/errors.hpp"
#include "provenance/records.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

NotFound unknown_run(std::string_view id);
NotFound unknown_checkpoint(std::string_view run, std::string_view sha256);
std::string run_stream(std::string_view id);  ///< "run/<id>"

/// Throws StoreDamaged when a run is to be longer, or its checkpoints further apart, than any run
/// of this program. Step counts could overflow.
void require_cycles(std::uint64_t target_cycles, std::uint64_t checkpoint_every);

/// One run, or all in the order of their declaration ("").
std::vector<RunRecord> query_runs(const sqlite::Database& database, std::string_view id = "");
/// Ids with this prefix, at most `limit`.
std::vector<std::string> query_run_ids(const sqlite::Database& database, std::string_view prefix,
                                       std::size_t limit);
/// Checkpoints of one run, or of all (""), in ascending order of step.
std::vector<CheckpointRecord> query_checkpoints(const sqlite::Database& database,
                                                std::string_view run = "");
std::optional<CheckpointRecord> query_checkpoint(const sqlite::Database& database,
                                                 std::string_view run, std::string_view sha256);
/// Checkpoints whose SHA-256 has this prefix, at most `limit`.
std::vector<CheckpointRecord> query_checkpoints_by_prefix(const sqlite::Database& database,
                                                          std::string_view prefix,
                                                          std::size_t limit);
std::vector<FigureRecord> query_figures(const sqlite::Database& database);

}  // namespace shearcell
