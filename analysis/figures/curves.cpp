// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/curves.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "analysis/error.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

bool matches(const nlohmann::json& a, const nlohmann::json& b) {
  if (a.is_number() && b.is_number()) {
    const auto x = a.get<double>();
    const auto y = b.get<double>();
    return std::abs(x - y) <= 0.03 * std::abs(y);
  }
  return a == b;
}

/// gnuplot's strcol() ends a field at every comma and does not read quotes as RFC 4180 does.
/// Variants of our manifests have no other special characters; those of a foreign store may.
std::string plain_field(std::string variant) {
  const auto odd = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x80 && std::isalnum(byte) == 0 &&
           std::string_view("=.+-_;: /").find(c) == std::string_view::npos;
  };
  std::replace_if(variant.begin(), variant.end(), odd, ';');
  return variant;
}

CurveStyle style_of_other(const std::string& variant, std::size_t index) {
  static const std::array<const char*, 6> colours = {"#1f78b4", "#33a02c", "#ff7f00",
                                                     "#6a3d9a", "#b15928", "#000000"};
  return {nullptr, variant, colours[index % colours.size()], 6 + 2 * static_cast<int>(index % 4)};
}

std::vector<CurvePoint> points_of(std::span<const FigureRun* const> runs) {
  std::map<std::int64_t, std::vector<const Measures*>> found;
  for (const FigureRun* run : runs) {
    std::set<std::int64_t> seen;
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      if (std::floor(checkpoint.cycle) != checkpoint.cycle) continue;
      const auto cycle = static_cast<std::int64_t>(checkpoint.cycle);
      if (!seen.insert(cycle).second) {
        throw AnalysisError("run " + run->run_id + " has two checkpoints of cycle " +
                            std::to_string(cycle));
      }
      found[cycle].push_back(&checkpoint.measures);
    }
  }
  std::vector<CurvePoint> points;
  for (auto& [cycle, measures] : found) points.push_back({cycle, std::move(measures)});
  return points;
}

std::string column_of(const MeasureColumn& measure, const char* statistic) {
  return measure.name + "_" + statistic + (measure.unit.empty() ? "" : "_" + measure.unit);
}

void add_columns(const MeasureColumn& measure, std::vector<std::string>& columns) {
  columns.push_back(column_of(measure, "mean"));
  columns.push_back(column_of(measure, "standard_error"));
}

void add_values(const RunStatistics& statistics, std::vector<TableValue>& row) {
  row.push_back(table_value(statistics.mean));
  row.push_back(table_value(statistics.standard_error));
}

const MeasureColumn crystalline = {"crystalline", "percent", &Measures::crystalline_percent};

}  // namespace

std::vector<Curve> curves_of(std::span<const FigureRun> runs, const std::string& parameter,
                             std::span<const CurveStyle> styles) {
  return curves_by(
      runs, [&](const FigureRun& run) { return parameter_of(run, parameter); }, styles);
}

std::vector<Curve> curves_by(std::span<const FigureRun> runs,
                             const std::function<nlohmann::json(const FigureRun&)>& value_of,
                             std::span<const CurveStyle> styles) {
  std::map<std::string, std::vector<const FigureRun*>> variants;
  for (const FigureRun& run : runs) variants[run.variant].push_back(&run);
  std::vector<std::pair<std::size_t, Curve>> ranked;
  for (auto& [variant, members] : variants) {
    Curve curve;
    curve.variant = plain_field(variant);
    curve.value = value_of(*members.front());
    curve.points = points_of(members);
    curve.runs = std::move(members);
    if (curve.points.empty()) continue;
    const auto style = std::find_if(styles.begin(), styles.end(), [&](const CurveStyle& s) {
      return matches(curve.value, s.value);
    });
    const auto rank = static_cast<std::size_t>(style - styles.begin());
    curve.style =
        style == styles.end() ? style_of_other(variant, styles.size() + ranked.size()) : *style;
    ranked.emplace_back(rank, std::move(curve));
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Curve> curves;
  for (auto& [rank, curve] : ranked) curves.push_back(std::move(curve));
  return curves;
}

const Curve* curve_with(std::span<const Curve> curves, const nlohmann::json& value) {
  for (const Curve& curve : curves) {
    if (matches(curve.value, value)) return &curve;
  }
  return nullptr;
}

RunStatistics over(const CurvePoint& point, const Quantity& quantity) {
  std::vector<double> values;
  values.reserve(point.runs.size());
  for (const Measures* measures : point.runs) values.push_back(quantity(*measures));
  return over_runs(values);
}

Axis cycle_axis() {
  return {.name = "shear cycle", .symbol = italic("n"), .whole = true};
}

Axis phi_axis() {
  return {.name = "volume fraction", .symbol = italic("ϕ")};
}

Axis crystalline_axis() {
  return {.name = "percentage crystalline", .unit = "%", .low = 0};
}

Axis overlap_axis() {
  return {.name = "mean overlap", .symbol = Text("⟨") + italic("δ") + "⟩", .unit = italic("d")};
}

Axis amplitude_axis() {
  return {.name = "amplitude", .symbol = italic("A"), .unit = "rad", .low = 0, .high = 0.12};
}

Axis onset_axis() {
  return {.name = "onset", .symbol = italic("ϕ")};
}

std::vector<ReferenceLine> onset_lines() {
  return {{published_onset_phi - published_onset_error},
          {published_onset_phi + published_onset_error}};
}

std::vector<Series> series_of(std::span<const Curve> curves, const SeriesColumns& columns) {
  std::vector<Series> series;
  for (const Curve& curve : curves) {
    series.push_back({.title = curve.style.title,
                      .colour = curve.style.colour,
                      .point = curve.style.point,
                      .join = Join::line,
                      .columns = columns,
                      .filter = {"variant", curve.variant}});
  }
  return series;
}

FigureTable against_cycle(const std::string& name, std::span<const Curve> curves,
                          std::span<const MeasureColumn> measures, Axis y) {
  FigureTable table{.name = name, .columns = {"variant", "cycle"}, .rows = {}};
  for (const MeasureColumn& measure : measures) add_columns(measure, table.columns);
  table.columns.emplace_back("runs");
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      auto& row = table.rows.emplace_back(std::vector<TableValue>{curve.variant, point.cycle});
      for (const MeasureColumn& measure : measures) add_values(over(point, measure.quantity), row);
      row.emplace_back(static_cast<std::int64_t>(over(point, measures.front().quantity).runs));
    }
  }
  table.chart = {
      .x = cycle_axis(),
      .y = std::move(y),
      .series = series_of(curves, {.x = "cycle",
                                   .y = column_of(measures.front(), "mean"),
                                   .y_error = column_of(measures.front(), "standard_error")})};
  return table;
}

FigureTable against_phi(const std::string& name, std::span<const Curve> curves,
                        const MeasureColumn& measure, Axis y) {
  FigureTable table{.name = name,
                    .columns = {"variant", "phi_low", "phi_high", "phi_mean", "phi_standard_error"},
                    .rows = {}};
  add_columns(measure, table.columns);
  table.columns.emplace_back("runs");
  for (const Curve& curve : curves) {
    for (const PhiBin& bin : binned_by_phi(curve.runs, measure.quantity)) {
      auto& row =
          table.rows.emplace_back(std::vector<TableValue>{curve.variant, bin.low, bin.high});
      add_values(bin.phi, row);
      add_values(bin.value, row);
      row.emplace_back(static_cast<std::int64_t>(bin.value.runs));
    }
  }
  table.chart = {.x = phi_axis(),
                 .y = std::move(y),
                 .series = series_of(curves, {.x = "phi_mean",
                                              .y = column_of(measure, "mean"),
                                              .x_error = "phi_standard_error",
                                              .y_error = column_of(measure, "standard_error")})};
  return table;
}

FigureTable phi_against_cycle(const std::string& name, std::span<const Curve> curves) {
  static const std::array<MeasureColumn, 3> measures = {
      {{"phi", "", &Measures::phi},
       {"phi_u", "", &Measures::phi_uncorrected},
       {"overlap", "d", &Measures::mean_overlap}}};
  return against_cycle(name, curves, measures, phi_axis());
}

FigureTable crystallinity_against_cycle(const std::string& name, std::span<const Curve> curves) {
  return against_cycle(name, curves, std::span(&crystalline, 1), crystalline_axis());
}

FigureTable crystallinity_against_phi(const std::string& name, std::span<const Curve> curves) {
  return against_phi(name, curves, crystalline, crystalline_axis());
}

}  // namespace shearcell
