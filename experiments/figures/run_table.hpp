// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of a store as one table with a row for each checkpoint or each run, and a column for
// each swept parameter and each scalar measure.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/figures/collect.hpp"

namespace shearcell {

enum class RowPer { checkpoint, run };
template <>
inline constexpr auto kNames<RowPer> = names_in_order<RowPer>("checkpoint", "run");

/// A table of runs, and messages on missing values.
struct RunTable : MeasureOutcome {
  Table table;                      ///< empty cells: the value is unknown or does not apply
  std::vector<std::string> notes;   ///< NewestRuns::notes, and a note on missing measures
  std::vector<FrameRun> histories;  ///< for RowPer::run: each row's checkpoints at whole cycles
};

/// Returns the table of the selected runs (see newest_runs()), sorted by run and cycle. Contains
/// the checkpoints from checkpoints_for(). Onsets are found in the checkpoints at whole cycles, as
/// in figures. If `simulated` lists providers, the table also has columns for their measures.
/// Throws NotFound as select_runs() does.
RunTable run_table(const Store& store, const RunSelection& selection, RowPer per,
                   const MeasureOptions& options, std::span<const std::string> simulated = {});

/// Returns a table with a row for each point of a measured curve at each checkpoint. The first
/// columns identify the run. The last four are the cycle, the checkpoint, x and y.
RunTable curve_table(const Store& store, const RunSelection& selection, const Measure& measure,
                     const MeasureOptions& options);

/// Names of the providers that compute numbers from the file of a checkpoint. "scalars" is first.
std::vector<std::string> table_providers();
/// Names of the providers that compute measures by a simulation (ComputedFrom::simulation).
std::vector<std::string> simulating_providers();

/// All columns except those of swept parameters. Includes the measures of simulating_providers().
std::vector<TableColumn> table_columns();

std::vector<std::pair<TableColumn, TableCell>> facts_of(const CheckpointRecord& record,
                                                        const Measures& measures);

/// The table as a JSON array of rows. If `notes` is true, the result is an object with this array
/// (`rows`), the notes of the table (`notes`), and messages on checkpoints that were not measured
/// (`damage`, `pruned`).
std::string to_json(const RunTable& made, bool notes = false);

/// Whether the beginning of a file shows that the file is a table of runs, in CSV or JSON.
bool is_table(std::string_view beginning);

}  // namespace shearcell
