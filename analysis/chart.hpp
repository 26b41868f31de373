// SPDX-License-Identifier: GPL-3.0-or-later
// A panel as a program may draw it with axes that a reader can zoom: what gnuplot draws from a
// table, as plain values.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearcell {

/// Empty (not measured, or no error from one run), a number, a whole number, or text.
using TableValue = std::variant<std::monostate, double, std::int64_t, std::string>;
using TableRows = std::vector<std::vector<TableValue>>;

/// Labels and titles are gnuplot enhanced text, as in the plot scripts.
struct ChartAxis {
  std::string label;
  bool log = false;
  std::optional<double> low =
      std::nullopt;  ///< where it begins unless data lie below; where the data do if empty
  std::optional<double> high = std::nullopt;
};

struct ChartPoint {
  double x = 0;
  double y = 0;
  std::optional<double> x_error;  ///< standard error, one sided
  std::optional<double> y_error;
};

struct ChartSeries {
  std::string title;
  std::string colour;  ///< "#rrggbb"
  int point = 7;       ///< gnuplot point type
  bool line = false;   ///< points are joined in their order
  std::vector<ChartPoint> points;
};

struct Chart {
  ChartAxis x;
  ChartAxis y;
  std::vector<ChartSeries> series;
  std::vector<double> levels;  ///< y of dashed horizontal lines
};

/// Columns of a table, counted from 1; 0 for an error means that there is none.
struct CurveColumns {
  int x;
  int x_error;
  int y;
  int y_error;
};

/// Of the rows that have `value` in column `column` (of all when it is 0). Rows in which x or y is
/// no finite number are left out.
std::vector<ChartPoint> chart_points(const TableRows& rows, const CurveColumns& columns,
                                     int column = 0, const TableValue& value = {});

/// Nine significant digits, as in the CSV. The same chart gives the same bytes.
nlohmann::json to_json(const Chart& chart);

}  // namespace shearcell
