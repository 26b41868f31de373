// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/axes.hpp"

#include <cmath>

namespace shearcell {

ReferenceLine critical_line(double size, const std::string& colour) {
  return {.at = size, .colour = colour, .title = "the supplement's critical sizes"};
}

void add_size_columns(const std::string& name, std::vector<TableColumn>& columns) {
  for (const char* ending : {"", "_low", "_high", "_standard_error"}) {
    columns.push_back(name + ending + "_grains");
  }
}

ChartPoint point_of(double x, const Estimate& size) {
  return {
      .x = x, .y = size.value, .y_error = size.spread / std::sqrt(static_cast<double>(size.runs))};
}

void add_size(const std::optional<Estimate>& size, TableRow& row) {
  if (!size) {
    row.resize(row.size() + 4);
    return;
  }
  row.insert(row.end(),
             {size->value, size->interval.low, size->interval.high, point_of(0, *size).y_error});
}

}  // namespace shearcell
