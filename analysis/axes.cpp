// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/axes.hpp"

#include <cmath>
#include <string_view>

namespace shearcell {

RunStatistics MeasureColumn::over(std::span<const double> values) const {
  return rms ? rms_over_runs(values) : over_runs(values);
}

std::string column_name(const MeasureColumn& measure, const char* statistic) {
  if (measure.rms && statistic == std::string_view("mean")) statistic = "rms";
  return measure.name + "_" + statistic + (measure.unit.empty() ? "" : "_" + measure.unit);
}

void add_columns(const MeasureColumn& measure, std::vector<TableColumn>& columns) {
  columns.push_back(column_name(measure, "mean"));
  columns.push_back(column_name(measure, "standard_error"));
}

void add_values(const RunStatistics& statistics, TableRow& row) {
  row.insert(row.end(), {statistics.mean, statistics.standard_error});
}

SeriesColumns columns_against(std::string x, const MeasureColumn& y) {
  return {.x = std::move(x),
          .y = column_name(y, "mean"),
          .y_error = column_name(y, "standard_error"),
          .runs = "runs"};
}

ReferenceLine critical_line(double size, const std::string& colour) {
  return {.at = size, .colour = colour, .title = "the supplement's critical sizes"};
}

void add_size_columns(const std::string& name, std::vector<TableColumn>& columns) {
  for (const char* ending : {"", "_low", "_high", "_standard_error"}) {
    columns.push_back(name + ending + "_grains");
  }
}

void add_size(const std::optional<Estimate>& size, TableRow& row) {
  if (!size) {
    row.resize(row.size() + 4);
    return;
  }
  row.insert(row.end(), {size->value, size->interval.low, size->interval.high,
                         size->spread / std::sqrt(static_cast<double>(size->runs))});
}

}  // namespace shearcell
