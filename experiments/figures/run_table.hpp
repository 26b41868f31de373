// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of a store as one table: a row for each checkpoint or each run, a column for each swept
// parameter and each scalar measure.
#pragma once

#include <algorithm>
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

/// A table of runs, and what is missing in it.
struct RunTable : MeasureOutcome {
  Table table;                      ///< a cell is empty if it is unknown or does not apply
  std::vector<std::string> notes;   ///< of newest_runs()
  std::vector<FrameRun> histories;  ///< with RowPer::run: each row's run at whole cycles
};

/// The table of the selected newest_runs(): by run, then by cycle. The checkpoints of a run are its
/// checkpoints_for() up to end_for(). Onsets are found in the checkpoints at whole cycles, as in
/// figures. `simulated` names simulating providers whose measures are added. Throws NotFound as
/// select_runs() does.
RunTable run_table(const Store& store, const RunSelection& selection, RowPer per,
                   const MeasureOptions& options, std::span<const std::string> simulated = {});

/// A table with a row for each value of a measured curve at each checkpoint: the run's columns, the
/// cycle, the checkpoint, x and y.
RunTable curve_table(const Store& store, const RunSelection& selection, const Measure& measure,
                     const MeasureOptions& options);

/// The providers of all columns of a checkpoint except simulated ones. The first is "scalars".
std::vector<std::string> table_providers();
std::vector<std::string> simulating_providers();

/// Every column, simulated ones too, except those of swept parameters.
std::vector<TableColumn> table_columns();

/// The columns of one checkpoint and their values.
std::vector<std::pair<TableColumn, TableCell>> facts_of(const CheckpointRecord& record,
                                                        const Measures& measures);

/// The table as a JSON array of rows. With `notes`, an object of this array (`rows`), lines on runs
/// that were left out (`notes`), and the checkpoints that were not measured (`damage`, `pruned`).
std::string to_json(const RunTable& made, bool notes = false);

/// Whether a file begins like the CSV or the JSON.
bool is_table(std::string_view beginning);

}  // namespace shearcell
