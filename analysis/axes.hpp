// SPDX-License-Identifier: GPL-3.0-or-later
// Axes, columns and reference lines that several figures share.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

inline const Axis cycle_axis = {.name = "shear cycle", .symbol = formula("$n$"), .whole = true};
inline const Axis phi_axis = {.name = "volume fraction", .symbol = formula("$ϕ$")};
inline const Axis crystalline_axis = {.name = "percentage crystalline", .unit = "%", .low = 0};
inline const Axis overlap_axis = {
    .name = "mean overlap", .symbol = formula("⟨$δ$⟩"), .unit = formula("$d$")};
inline const Axis amplitude_axis = {
    .name = "amplitude", .symbol = formula("$A$"), .unit = "rad", .low = 0, .high = 0.12};

/// A line at the supplement's critical size [grains] for one amplitude.
ReferenceLine critical_line(double size, const std::string& colour);

/// Adds columns for a size, the ends of its interval and its standard error, all in grains.
void add_size_columns(const std::string& name, std::vector<TableColumn>& columns);
/// Adds the values for the columns of add_size_columns(); empty cells if there is no estimate.
void add_size(const std::optional<Estimate>& size, TableRow& row);

/// A quantity with the columns NAME_mean_UNIT (or NAME_rms_UNIT) and NAME_standard_error_UNIT.
struct MeasureColumn {
  std::string name;
  std::string unit;  ///< as in column names: "d", "percent" or ""
  bool rms = false;  ///< root mean square over runs instead of the mean

  RunStatistics over(std::span<const double> values) const;  ///< `values`: one per run
};

/// Name of the column for `statistic`, which is "mean" or "standard_error". If MeasureColumn::rms
/// is true, "rms" replaces "mean".
std::string column_name(const MeasureColumn& measure, const char* statistic);
void add_columns(const MeasureColumn& measure, std::vector<TableColumn>& columns);
void add_values(const RunStatistics& statistics, TableRow& row);
/// The columns to draw: x, the mean of the measure `y`, its standard error, and the number of runs.
SeriesColumns columns_against(std::string x, const MeasureColumn& y);

}  // namespace shearcell
