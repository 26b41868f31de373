// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/chart.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace shearcell {
namespace {

using nlohmann::json;

std::optional<double> number_in(const std::vector<TableValue>& row, int column) {
  if (column < 1 || static_cast<std::size_t>(column) > row.size()) return std::nullopt;
  const TableValue& value = row[static_cast<std::size_t>(column) - 1];
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  const auto* real = std::get_if<double>(&value);
  if (real == nullptr || !std::isfinite(*real)) return std::nullopt;
  return *real;
}

double rounded(double value) {
  return std::strtod(fmt::format("{:.9g}", value).c_str(), nullptr);
}

json to_json(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? json(rounded(*value)) : json();
}

json to_json(const ChartAxis& axis) {
  return {{"label", axis.label},
          {"log", axis.log},
          {"low", to_json(axis.low)},
          {"high", to_json(axis.high)}};
}

json to_json(const ChartSeries& series) {
  json points = json::array();
  for (const ChartPoint& p : series.points) {
    points.push_back({rounded(p.x), rounded(p.y), to_json(p.x_error), to_json(p.y_error)});
  }
  return {{"title", series.title},
          {"colour", series.colour},
          {"point", series.point},
          {"line", series.line},
          {"points", std::move(points)}};
}

}  // namespace

std::vector<ChartPoint> chart_points(const TableRows& rows, const CurveColumns& columns, int column,
                                     const TableValue& value) {
  std::vector<ChartPoint> points;
  for (const std::vector<TableValue>& row : rows) {
    if (column > 0 && row.at(static_cast<std::size_t>(column) - 1) != value) continue;
    const auto x = number_in(row, columns.x);
    const auto y = number_in(row, columns.y);
    if (!x || !y) continue;
    points.push_back({*x, *y, number_in(row, columns.x_error), number_in(row, columns.y_error)});
  }
  return points;
}

json to_json(const Chart& chart) {
  json series = json::array();
  for (const ChartSeries& one : chart.series) series.push_back(to_json(one));
  json levels = json::array();
  for (const double level : chart.levels) levels.push_back(rounded(level));
  return {{"x", to_json(chart.x)},
          {"y", to_json(chart.y)},
          {"series", std::move(series)},
          {"levels", std::move(levels)}};
}

}  // namespace shearcell
