// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/own_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "analysis/figures/curves.hpp"
#include "analysis/onset.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

/// Splits a measure's name: "deviator_Pa" is the column "deviator" with the unit "Pa".
MeasureColumn column_of(std::string_view measure, std::string_view of) {
  std::string name(measure);
  std::string unit(of == "%" ? "percent" : of == "1" ? "" : of == "d^2" ? "d2" : of);
  if (unit.starts_with("1/")) unit.replace(0, 2, "per_");
  if (!unit.empty() && name.ends_with("_" + unit)) name.resize(name.size() - unit.size() - 1);
  return {std::move(name), std::move(unit), std::string(measure)};
}

/// The column of a number, which must exist.
MeasureColumn scalar_column(std::string_view name) {
  return column_of(name, find_measure(name)->unit);
}

const Measure* find_curve(std::string_view name) {
  return find_measure(name, MeasureKind::curve);
}

/// The axis of "largest_crystallite" is named "largest crystallite". It has the unit in brackets if
/// the name ends in it.
Axis named_axis(std::string_view measure, std::string_view unit) {
  std::string name = column_of(measure, unit).name;
  const bool has_unit = name.size() < measure.size();
  std::ranges::replace(name, '_', ' ');
  if (!has_unit) return {.name = std::move(name)};
  return {.name = std::move(name), .unit = Text(unit == "d^2" ? "d²" : std::string(unit))};
}

Axis axis_of(const std::string& key) {
  if (key == "cycle") return cycle_axis();
  if (key == "phi") return phi_axis();
  if (key == "crystalline_percent") return crystalline_axis();
  if (key == "mean_overlap_d") return overlap_axis();
  if (const Measure* measure = find_measure(key)) return named_axis(key, measure->unit);
  if (const Measure* measure = find_curve(key)) return named_axis(key, measure->unit);
  return named_axis(key, "1");
}

/// "cycle" of a shear, "step" of a stiffening, or both if the runs are of both.
std::string_view word_for_cycle(std::span<const FigureRun> runs) {
  const auto stiffens = [](const FigureRun& run) {
    return !run.checkpoints.empty() &&
           std::isfinite(run.checkpoints.front().measures.number("raised_stiffness_N_per_m"));
  };
  if (std::ranges::none_of(runs, stiffens)) return "cycle";
  return std::ranges::all_of(runs, stiffens) ? "step" : "cycle or step";
}

Axis x_axis(const PlotSpec& plot, std::span<const FigureRun> runs) {
  if (const Measure* y = find_curve(plot.y)) return named_axis(y->x, y->x_unit);
  if (!plot.x_symbol.empty()) {
    return {.symbol = italic(plot.x_symbol),
            .unit = plot.x_unit.empty() ? Text() : Text(plot.x_unit)};
  }
  if (!plot.x_unit.empty()) return named_axis(plot.x, plot.x_unit);
  const std::string_view word = word_for_cycle(runs);
  if (plot.x != "cycle" || word == "cycle") return axis_of(plot.x);
  return {.name = fmt::format("{} of the stiffening", word), .whole = true};
}

/// The cycle of the plot: as stated, or the last that all runs have.
double cycle_of(const PlotSpec& plot, std::span<const FigureRun> runs) {
  if (plot.cycle) return static_cast<double>(*plot.cycle);
  std::map<double, std::size_t> count;  // of the runs with this cycle
  std::size_t begun = 0;
  for (const FigureRun& run : runs) {
    if (!run.checkpoints.empty()) ++begun;
    for (const CheckpointMeasures& checkpoint : run.checkpoints) ++count[checkpoint.cycle];
  }
  const auto last = std::find_if(count.rbegin(), count.rend(),
                                 [&](const auto& cycle) { return cycle.second == begun; });
  return last == count.rend() ? std::numeric_limits<double>::infinity() : last->first;
}

/// The checkpoint at a cycle; null if there is none.
const Measures* measures_at(const FigureRun& run, double cycle) {
  const auto found = std::ranges::find(run.checkpoints, cycle, &CheckpointMeasures::cycle);
  return found == run.checkpoints.end() ? nullptr : &found->measures;
}

/// A copy of the runs in which `variant` is the curve: runs that differ in `x` alone, or runs with
/// the same value of `by`, share a curve. A curve of one variant keeps its name.
std::vector<FigureRun> by_curve(std::span<const FigureRun> runs, const PlotSpec& plot,
                                const NameVariants& name) {
  std::vector<std::string> keys = varied_keys(runs, plot.x);
  std::erase(keys, plot.x);
  if (!plot.by.empty()) keys = {plot.by};
  std::vector<FigureRun> found(runs.begin(), runs.end());
  std::map<std::string, std::set<std::string>> names;
  for (FigureRun& run : found) {
    nlohmann::json swept = nlohmann::json::object();
    for (const std::string& key : keys) {
      if (nlohmann::json value = parameter_of(run, key); !value.is_null()) swept[key] = value;
    }
    if (run.swept.is_object()) run.parameters.update(run.swept);
    run.swept = std::move(swept);
    run.variant = run.swept.empty() ? "all" : words_of(run.swept);
    names[run.variant].insert(run.name);
  }
  std::vector<nlohmann::json> curves;
  for (const FigureRun& run : found) curves.push_back(run.swept);
  const auto shared = name ? name(curves) : std::map<nlohmann::json, std::string>();
  for (FigureRun& run : found) {
    if (names.at(run.variant).size() == 1 && !run.name.empty()) continue;
    run.name = name && !keys.empty() ? shared.at(run.swept) : run.variant;
  }
  return found;
}

/// Curves without symbols, which would hide them: each has its own colour, and dashes once these
/// run out.
void style_without_symbol(std::size_t curve, Series& series) {
  series.colour = safe_colours[curve % safe_colours.size()];
  series.point = 0;
  if (curve / safe_colours.size() % 2 == 1) series.join = Join::dashes;
}

/// Every run against the cycle, or against a measure `x`.
FigureTable traces(const PlotSpec& plot, std::span<const Curve> curves) {
  const Measure* x = find_measure(plot.x);
  FigureTable table{.name = plot.name, .columns = {"variant", "seed"}};
  if (x != nullptr) table.columns.emplace_back("cycle");
  table.columns.insert(table.columns.end(), {plot.x, plot.y});
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const Curve& curve = curves[k];
    Text title = curve.style.title;  // once in the key
    for (const FigureRun* run : curve.runs) {
      Series series = thin_line(std::exchange(title, Text()), curve.style.colour);
      style_without_symbol(k, series);
      for (const CheckpointMeasures& c : run->checkpoints) {
        const double at = x == nullptr ? c.cycle : c.measures.number(plot.x);
        const double value = c.measures.number(plot.y);
        TableRow& row = table.rows.emplace_back(TableRow{curve.variant, run->seed});
        if (x != nullptr) row.emplace_back(c.cycle);
        row.insert(row.end(), {at, value});
        if (std::isfinite(at) && std::isfinite(value)) series.points.push_back({at, value});
      }
      table.chart.series.push_back(std::move(series));
    }
  }
  return table;
}

/// The data of one curve: y against x of each trace, and the values of all traces at each x.
struct Points {
  std::map<std::uint64_t, std::map<double, double>> traces;
  std::map<double, std::vector<double>> values;

  void add(std::uint64_t trace, double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    traces[trace][x] = y;
    values[x].push_back(y);
  }
};

/// Against a parameter: one number of each run, a trace for each seed. Of a curve measure: the
/// curve of each run, a trace for each run. Checkpoints are those of `cycle`.
Points points_of(const PlotSpec& plot, const Curve& curve, double cycle) {
  const Measure* of_run = find_measure(plot.y, MeasureKind::run);
  const Measure* of_curve = find_curve(plot.y);
  Points points;
  for (std::size_t r = 0; r < curve.runs.size(); ++r) {
    const FigureRun& run = *curve.runs[r];
    if (of_run != nullptr) {
      points.add(run.seed, number_of(run, plot.x), of_run->of_run(run).or_nan());
      continue;
    }
    const Measures* measures = measures_at(run, cycle);
    if (measures == nullptr) continue;
    if (of_curve == nullptr) {
      points.add(run.seed, number_of(run, plot.x), measures->number(plot.y));
      continue;
    }
    const auto measured = measures->curves.find(plot.y);
    if (measured == measures->curves.end()) continue;
    const auto& [x, y] = measured->second;
    for (std::size_t i = 0; i < x.size(); ++i) points.add(r, x[i], y[i]);
  }
  return points;
}

/// A sentence of the caption: which checkpoints, and how many runs have no value. `cycle` is none
/// for a number of the whole run.
std::string note_of(const PlotSpec& plot, std::optional<double> cycle,
                    std::span<const FigureRun> runs, std::size_t with_value) {
  if (cycle && std::isfinite(*cycle)) {
    return fmt::format("At {} {}{}", word_for_cycle(runs), *cycle,
                       plot.cycle ? "" : ", the last that all runs have");
  }
  if (cycle || with_value == runs.size()) return "";
  return fmt::format("{} of {} runs have no value and are left out of the means",
                     runs.size() - with_value, runs.size());
}

/// Against a parameter, or of a curve measure: the mean over the runs at each x, or each trace.
FigureTable against_x(const PlotSpec& plot, std::span<const FigureRun> runs,
                      std::span<const Curve> curves) {
  const Measure* of_curve = find_curve(plot.y);
  const std::string x(of_curve != nullptr ? of_curve->x : plot.x);
  const bool of_whole_run = find_measure(plot.y, MeasureKind::run) != nullptr;
  const MeasureColumn y = of_curve != nullptr ? column_of(plot.y, of_curve->unit)
                          : of_whole_run      ? column_of(plot.y, "1")
                                              : scalar_column(plot.y);
  const double cycle = cycle_of(plot, runs);
  FigureTable table{.name = plot.name, .columns = {"variant", x}};
  add_columns(y, table.columns);
  table.columns.emplace_back("runs");
  if (!of_whole_run) table.columns.emplace_back("cycle");
  std::vector<Series> traces;
  std::size_t with_value = 0;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const Curve& curve = curves[k];
    const Points points = points_of(plot, curve, cycle);
    Text title = curve.style.title;  // once in the key
    for (const auto& [trace, values] : points.traces) {
      traces.push_back(
          thin_line(std::exchange(title, Text()), curve.style.colour, curve.style.point));
      if (of_curve != nullptr) style_without_symbol(k, traces.back());
      for (const auto& [at, value] : values) traces.back().points.push_back({at, value});
    }
    for (const auto& [at, values] : points.values) {
      TableRow& row = table.rows.emplace_back(TableRow{curve.variant, at});
      const RunStatistics over = over_runs(values);
      add_values(over, row);
      row.emplace_back(over.runs);
      if (!of_whole_run) row.emplace_back(cycle);
      with_value += over.runs;
    }
  }
  table.chart.series = series_of(curves, columns_against(x, y));
  for (std::size_t k = 0; k < curves.size(); ++k) {
    if (of_curve != nullptr) style_without_symbol(k, table.chart.series[k]);
    table.chart.series[k].band = of_curve != nullptr;
    if (of_curve == nullptr) table.chart.series[k].runs = 0;  // those at each x are others
  }
  if (plot.show == Show::traces) table.chart.series = std::move(traces);
  for (Series& series : table.chart.series) {
    if (curves.size() == 1) series.title = {};
  }
  table.chart.note =
      note_of(plot, of_whole_run ? std::nullopt : std::optional(cycle), runs, with_value);
  return table;
}

/// Means of both measures at each cycle, over the runs that have both.
FigureTable against_measure(const PlotSpec& plot, std::span<const Curve> curves) {
  std::array<MeasureColumn, 2> both = {scalar_column(plot.y), scalar_column(plot.x)};
  both[0].known = plot.x, both[1].known = plot.y;
  FigureTable table = against_cycle(plot.name, curves, both, {});
  table.chart.series = series_of(curves, columns_against(column_name(both[1], "mean"), both[0]));
  table.chart.note.clear();  // of lines that are not drawn
  return table;
}

FigureTable draw(const PlotSpec& plot, std::span<const FigureRun> given,
                 const NameVariants& names) {
  const Measure* measured = find_curve(plot.y);
  const bool by_parameter = measured == nullptr && is_parameter(plot.x);
  const bool grouped = by_parameter || !plot.by.empty();
  const std::vector<FigureRun> groups =
      grouped ? by_curve(given, plot, names) : std::vector<FigureRun>();
  const std::vector<Curve> curves =
      curves_by(grouped ? groups : given, {}, [](const FigureRun&) { return nullptr; }, {});
  if (by_parameter || measured != nullptr) return against_x(plot, given, curves);
  const MeasureColumn column = scalar_column(plot.y);
  if (plot.show == Show::traces) return traces(plot, curves);
  if (plot.x == "cycle") return against_cycle(plot.name, curves, {&column, 1}, {});
  if (plot.x == "phi") return against_phi(plot.name, curves, column, {});
  return against_measure(plot, curves);
}

}  // namespace

std::string words_of(const nlohmann::json& values) {
  std::string text;
  for (const auto& [key, value] : values.items()) {
    text += (text.empty() ? "" : ", ") + key + "=" + value_text(value);
  }
  return text;
}

bool is_parameter(std::string_view x) {
  return x != "cycle" && find_measure(x) == nullptr;
}

bool draws_every_cycle(const PlotSpec& plot) {
  return find_curve(plot.y) == nullptr && !is_parameter(plot.x);
}

Figure plot_figure(const PlotSpec& plot, const NameVariants& names) {
  const Measure* measured = find_curve(plot.y);
  const std::string x(measured == nullptr ? plot.x : measured->x);
  Figure figure{plot.name, plot.y + " against " + x,
                [plot, names](std::span<const FigureRun> runs) {
                  FigureTable table = draw(plot, runs, names);
                  table.chart.x = x_axis(plot, runs);
                  table.chart.y = axis_of(plot.y);
                  table.chart.x.log = plot.log == LogAxes::x || plot.log == LogAxes::xy;
                  table.chart.y.log = plot.log == LogAxes::y || plot.log == LogAxes::xy;
                  for (Axis* axis : {&table.chart.x, &table.chart.y}) {
                    if (axis->log) axis->low = {};
                  }
                  return FigureResult{{std::move(table)}, {}};
                }};
  if (measured != nullptr) figure.needs.push_back(provider_of(*measured).name);
  for (const std::string& name : {plot.x, plot.y}) {
    if (const Measure* one = find_measure(name)) figure.needs.push_back(provider_of(*one).name);
  }
  figure.within = plot.cycles;
  if (plot.cycle && !draws_every_cycle(plot) && find_measure(plot.y, MeasureKind::run) == nullptr) {
    figure.within = {{*plot.cycle, *plot.cycle}};
  }
  if (!plot.by.empty()) {
    figure.form = FigureForm::groups;
    figure.keys = {plot.by, x};
  }
  return figure;
}

}  // namespace shearcell
