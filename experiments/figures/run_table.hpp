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

/// A column. Its name ends in the unit, except for counts and pure numbers.
struct TableColumn {
  std::string name;
  std::string meaning;
};

enum class RowPer { checkpoint, run };
template <>
inline constexpr auto kNames<RowPer> = names_in_order<RowPer>("checkpoint", "run");

struct RunTable : MeasureOutcome {
  std::vector<TableColumn> columns;
  std::vector<std::vector<nlohmann::json>> rows;  ///< null: not applicable or unknown
  std::vector<std::string> notes;                 ///< of newest_runs()
  std::vector<FigureRun> histories;               ///< with RowPer::run: each row's whole cycles

  /// The index of a column; the number of columns if there is none of that name.
  std::size_t place(std::string_view name) const {
    return static_cast<std::size_t>(std::ranges::find(columns, name, &TableColumn::name) -
                                    columns.begin());
  }
};

/// The table of the selected newest_runs(), in their order, then by cycle, with their
/// checkpoints_for() up to end_for(). Onsets come from the checkpoints at whole cycles, as in
/// figures. `simulated` names simulating providers whose measures are added. Throws NotFound as
/// select_runs().
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
std::vector<std::pair<TableColumn, nlohmann::json>> facts_of(const CheckpointRecord& record,
                                                             const Measures& measures);

/// RFC 4180 with a header row; numbers have the shortest digits that read back to the same double.
std::string to_csv(const RunTable& table);
/// An array of objects, one for each row, keys in the order of the columns. With `notes` an object:
/// `rows`, that array; `notes` on runs that were left out; `damage` and `pruned`, the checkpoints
/// that were not measured.
std::string to_json(const RunTable& table, bool notes = false);

/// Whether a file begins like the CSV or the JSON.
bool is_table(std::string_view beginning);

}  // namespace shearcell
