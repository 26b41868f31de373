// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of a store as one table: a row for each checkpoint or each run, a column for each swept
// parameter and each scalar measure.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/figures/select_runs.hpp"
#include "experiments/runner/measure.hpp"

namespace shearcell {

/// A column and what it holds. Names end in their unit, except counts and pure numbers.
struct TableColumn {
  std::string name;
  std::string meaning;
};

enum class RowPer { checkpoint, run };
template <>
inline constexpr auto kNames<RowPer> = names_in_order<RowPer>("checkpoint", "run");

struct RunTable : MeasureOutcome {
  std::vector<TableColumn> columns;
  std::vector<std::vector<nlohmann::json>> rows;  ///< null: it does not apply or is not known
  std::vector<std::string> notes;                 ///< of newest_runs()

  /// Of a column; their number if there is none of that name.
  std::size_t place(std::string_view name) const {
    return static_cast<std::size_t>(std::ranges::find(columns, name, &TableColumn::name) -
                                    columns.begin());
  }
};

/// Rows in the order of declaration, then by cycle. The runs are newest_runs().
/// Checkpoints count up to own_end(); rejected ones do not. Onsets
/// come from the checkpoints at whole cycles, as in the figures. Throws NotFound as select_runs().
/// With `ledger` it also has the energy of each cycle, which is simulated again for that.
RunTable run_table(const Store& store, const RunSelection& selection, RowPer per,
                   const MeasureOptions& options, bool ledger = false);

/// A row for each value of a measured curve at each checkpoint: the run's columns, the cycle, the
/// checkpoint, x and y. Otherwise as run_table().
RunTable curve_table(const Store& store, const RunSelection& selection, const CurveMeasure& measure,
                     const MeasureOptions& options);

/// Names for measures_of() of what the columns show of a checkpoint; those of the first alone are
/// its scalars.
std::span<const std::string> table_measures();

/// Every column, those of a ledger included, except those of swept parameters, which are named as
/// in a manifest.
std::vector<TableColumn> table_columns();

/// Names and values of what is known of one checkpoint, in the order of the columns.
std::vector<std::pair<TableColumn, nlohmann::json>> facts_of(
    const CheckpointRecord& record, const std::optional<Measures>& measures);

/// RFC 4180 with a header row; numbers have the shortest digits that read back to the same double.
std::string to_csv(const RunTable& table);
/// An array of objects, one for each row, keys in the order of the columns.
std::string to_json(const RunTable& table);

/// Whether a file begins like one of the two.
bool is_table(std::string_view beginning);

}  // namespace shearcell
