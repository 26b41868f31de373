// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/own_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/expression.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/onset.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

/// Splits a measure's name: "deviator_Pa" is the column "deviator" with the unit "Pa".
MeasureColumn column_of(std::string_view measure, std::string_view of) {
  std::string name(measure);
  std::string unit(of == "%" ? "percent" : of == "1" ? "" : of);
  if (unit.starts_with("1/")) unit.replace(0, 2, "per_");
  if (const auto slash = unit.find('/'); slash != std::string::npos) {
    unit.replace(slash, 1, "_per_");  // "m/s"
  }
  std::ranges::replace(unit, ' ', '_');
  std::erase(unit, '^');
  if (!unit.empty() && name.ends_with("_" + unit)) name.resize(name.size() - unit.size() - 1);
  return {std::move(name), std::move(unit), std::string(measure)};
}

const Measure* find_curve(std::string_view name) {
  return find_measure(name, MeasureKind::curve);
}

/// A number of checkpoints or of a whole run, or a curve; null if the text is none of them.
const Measure* find_plotted(std::string_view text) {
  const Measure* measure = find_measure(text);
  if (measure == nullptr) measure = find_measure(text, MeasureKind::run);
  return measure != nullptr ? measure : find_curve(text);
}

/// The column of such a measure, or of an expression. `name` replaces its name.
MeasureColumn column_for(const std::string& text, const std::string& name = {}) {
  MeasureColumn column = {is_expression(text) ? "(" + text + ")" : text, "", text};
  if (const Measure* measure = find_plotted(text)) column = column_of(text, measure->unit);
  if (!name.empty()) column.name = name;
  return column;
}

MeasureColumn y_column(const PlotSpec& plot) {
  MeasureColumn column = column_for(plot.y);
  if (!plot.minus.empty()) column.name += "_difference";
  column.rms = plot.show == Show::rms;
  return column;
}

/// The axis of "largest_crystallite" is named "largest crystallite". It has the unit in brackets if
/// the name ends in it.
Axis named_axis(std::string_view measure, std::string_view unit) {
  std::string name = column_of(measure, unit).name;
  const bool has_unit = name.size() < measure.size();
  std::ranges::replace(name, '_', ' ');
  if (!has_unit) return {.name = std::move(name)};
  std::string of(unit);
  while (of.find("^2") != std::string::npos) of.replace(of.find("^2"), 2, "²");
  return {.name = std::move(name), .unit = Text(of)};
}

Axis axis_of(const std::string& key) {
  if (key == "cycle") return cycle_axis;
  if (key == "phi") return phi_axis;
  if (key == "crystalline_percent") return crystalline_axis;
  if (key == "mean_overlap_d") return overlap_axis;
  if (const Measure* measure = find_plotted(key)) return named_axis(key, measure->unit);
  return is_expression(key) ? Axis{.name = key} : named_axis(key, "1");
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

/// A logarithmic axis has no fixed lower end.
void adapt(Axis& axis, const std::string& label, bool log) {
  axis.log = log;
  if (log) axis.low = {};
  if (label.empty()) return;
  axis.name = formula(label);
  axis.symbol = axis.unit = {};
}

Axis x_axis(const PlotSpec& plot, std::span<const FigureRun> runs) {
  if (const Measure* y = find_curve(plot.y)) return named_axis(y->x, y->x_unit);
  if (!plot.x_symbol.empty()) {
    return {.symbol = formula("$" + plot.x_symbol + "$"),
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
  return last == count.rend() ? infinite : last->first;
}

/// The checkpoint at a cycle; null if there is none.
const Measures* measures_at(const FigureRun& run, double cycle) {
  const auto found = std::ranges::find(run.checkpoints, cycle, &CheckpointMeasures::cycle);
  return found == run.checkpoints.end() ? nullptr : &found->measures;
}

/// The y of a run, which is no curve: a number of the whole run, or of its checkpoint at the cycle.
/// Not a number if it has none.
double y_of(const PlotSpec& plot, const FigureRun& run, double cycle) {
  if (is_parameter(plot.y)) return number_of(run, plot.y);
  const Measures* measures = measures_at(run, cycle);
  return measures == nullptr ? std::nan("") : measures->number(plot.y);
}

/// Sets each run's x, a measure of the whole run, to its mean over those runs of the variant that
/// have a y, so that these share a point.
void average_x(const PlotSpec& plot, std::vector<FigureRun>& runs) {
  const double cycle = cycle_of(plot, runs);
  std::map<std::string, std::vector<double>> found;  // of each variant
  for (const FigureRun& run : runs) {
    std::vector<double>& of_variant = found[run.place.variant];
    if (std::isfinite(y_of(plot, run, cycle))) of_variant.push_back(number_of(run, plot.x));
  }
  for (FigureRun& run : runs) {
    const std::optional<double> mean = over_runs(found.at(run.place.variant)).mean;
    run.parameters[plot.x] = mean.value_or(std::nan(""));
  }
}

/// Replaces y by its difference from the runs of PlotSpec::minus, and removes these, runs without a
/// partner, and checkpoints of cycles that the partner lacks. Returns a sentence for the caption.
std::string subtract(const PlotSpec& plot, std::vector<FigureRun>& runs) {
  const std::vector<FigureRun> all = std::exchange(runs, {});
  const std::vector<const FigureRun*> others = runs_with(plot.minus, all);
  const std::size_t variants = count_variants(others);
  if (variants > 1 && !plot.listed) {
    throw UsageError(fmt::format("plot {}: {}", plot.name, problem_of_minus(plot, variants)));
  }
  if (variants != 1) {
    return fmt::format("{} {}", variants == 0 ? "No run has" : "Several variants have",
                       words_of(plot.minus));
  }
  const PackingGroups packings = by_packing(others);
  for (const FigureRun& run : all) {
    const auto same = packings.find(packing_of(run));
    if (same == packings.end() || std::ranges::count(others, &run) > 0) continue;
    // The mean over its partners: several where the runs of a packing differ by noise.
    const auto of_partners = [&, &partners = same->second](double cycle) {
      std::vector<double> values;
      for (const FigureRun* partner : partners) values.push_back(y_of(plot, *partner, cycle));
      return over_runs(values).mean.value_or(std::nan(""));
    };
    FigureRun& one = runs.emplace_back(run);
    if (is_parameter(plot.y)) {
      one.parameters[plot.y] = number_of(run, plot.y) - of_partners(0);
      continue;
    }
    std::erase_if(one.checkpoints, [&](CheckpointMeasures& checkpoint) {
      const double other = of_partners(checkpoint.cycle);
      const double own = checkpoint.measures.number(plot.y);
      checkpoint.measures.numbers[plot.y] = own - other;
      return std::isnan(other);
    });
  }
  const std::size_t alone = all.size() - others.size() - runs.size();
  const std::string& name = others.front()->name;
  return fmt::format(
      "Differences from {} with the same packing{}", name.empty() ? words_of(plot.minus) : name,
      alone == 0 ? ""
                 : fmt::format(", which {} of {} runs lack", alone, all.size() - others.size()));
}

/// A copy of the runs in which `variant` is the curve: runs that differ in `x` alone, or runs with
/// the same value of `by`, share a curve. A curve of one variant keeps its name.
std::vector<FigureRun> by_curve(std::span<const FigureRun> runs, const PlotSpec& plot,
                                const NameVariants& name) {
  std::vector<std::string> keys = varied_keys(runs, plot.x);
  for (const std::string& used : names_in(plot.x)) std::erase(keys, used);
  std::erase(keys, plot.panel);
  if (!plot.by.empty()) keys = {plot.by};
  std::vector<FigureRun> found(runs.begin(), runs.end());
  std::map<std::string, std::set<std::string>> names;
  for (FigureRun& run : found) {
    nlohmann::json swept = nlohmann::json::object();
    for (const std::string& key : keys) {
      if (nlohmann::json value = parameter_of(run, key); !value.is_null()) swept[key] = value;
    }
    if (run.place.swept.is_object()) run.parameters.update(run.place.swept);
    run.place.swept = std::move(swept);
    run.place.variant = run.place.swept.empty() ? "all" : words_of(run.place.swept);
    names[run.place.variant].insert(run.name);
  }
  std::vector<nlohmann::json> curves;
  for (const FigureRun& run : found) curves.push_back(run.place.swept);
  const auto shared = name ? name(curves) : std::map<nlohmann::json, std::string>();
  for (FigureRun& run : found) {
    const bool of_one_variant = names.at(run.place.variant).size() == 1 && !run.name.empty();
    if (of_one_variant && plot.panel.empty()) continue;
    run.name = name && !keys.empty() ? shared.at(run.place.swept) : run.place.variant;
  }
  return found;
}

/// Whether the plot draws runs, not numbers over runs.
bool draws_runs(const PlotSpec& plot) {
  return plot.show == Show::traces || plot.show == Show::scatter;
}

/// Curves without symbols, which would hide them: each has its own colour, and dashes once these
/// run out, unless the plot states its colours.
void style_without_symbol(const PlotSpec& plot, std::size_t curve, Series& series) {
  series.point = 0;
  if (!plot.series.empty()) return;
  series.colour = safe_colours[curve % safe_colours.size()];
  if (curve / safe_colours.size() % 2 == 1) series.join = Join::dashes;
}

/// Every run against the cycle, or against a number of the checkpoints.
FigureTable traces(const PlotSpec& plot, std::span<const Curve> curves) {
  const bool x = plot.x != "cycle";
  FigureTable table{.name = plot.name, .columns = {"variant", "seed"}};
  if (x) table.columns.emplace_back("cycle");
  table.columns.insert(table.columns.end(),
                       {plot.x, plot.y + (plot.minus.empty() ? "" : "_difference")});
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const Curve& curve = curves[k];
    Text title = curve.style.title;  // once in the key
    for (const FigureRun* run : curve.runs) {
      Series series =
          thin_line(std::exchange(title, Text()), curve.style.colour, curve.style.point);
      if (plot.show == Show::scatter) {
        series.join = Join::none;
      } else {
        style_without_symbol(plot, k, series);
      }
      for (const CheckpointMeasures& c : run->checkpoints) {
        const double at = x ? c.measures.number(plot.x) : c.cycle;
        const double value = c.measures.number(plot.y);
        TableRow& row = table.rows.emplace_back(TableRow{curve.variant, run->place.seed});
        if (x) row.emplace_back(c.cycle);
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
  struct Values {
    std::vector<const FigureRun*> runs;
    std::vector<double> values;  // one per run
  };
  std::map<double, Values> values;

  void add(std::uint64_t trace, const FigureRun& run, double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    traces[trace][x] = y;
    values[x].runs.push_back(&run);
    values[x].values.push_back(y);
  }
};

/// Against a parameter: one number of each run, a trace for each seed. Of a curve measure: the
/// curve of each run, a trace for each run. Checkpoints are those of `cycle`.
Points points_of(const PlotSpec& plot, const Curve& curve, double cycle) {
  const Measure* of_curve = find_curve(plot.y);
  Points points;
  for (std::size_t r = 0; r < curve.runs.size(); ++r) {
    const FigureRun& run = *curve.runs[r];
    if (of_curve == nullptr) {
      points.add(run.place.seed, run, number_of(run, plot.x), y_of(plot, run, cycle));
      continue;
    }
    const Measures* measures = measures_at(run, cycle);
    if (measures == nullptr) continue;
    const auto measured = measures->curves.find(plot.y);
    if (measured == measures->curves.end()) continue;
    const auto& [x, y] = measured->second;
    for (std::size_t i = 0; i < x.size(); ++i) points.add(r, run, x[i], y[i]);
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
  const bool of_whole_run = is_parameter(plot.y);
  const MeasureColumn y = y_column(plot);
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
      if (plot.show == Show::scatter) traces.back().join = Join::none;
      if (of_curve != nullptr) style_without_symbol(plot, k, traces.back());
      for (const auto& [at, value] : values) traces.back().points.push_back({at, value});
    }
    for (const auto& [at, values] : points.values) {
      TableRow& row = table.rows.emplace_back(TableRow{curve.variant, at});
      const RunStatistics over = y.over(over_packings(values.runs, values.values));
      add_values(over, row);
      row.emplace_back(over.runs);
      if (!of_whole_run) row.emplace_back(cycle);
      with_value += values.runs.size();
    }
  }
  table.chart.series = series_of(curves, columns_against(x, y));
  for (std::size_t k = 0; k < curves.size(); ++k) {
    if (of_curve != nullptr) style_without_symbol(plot, k, table.chart.series[k]);
    table.chart.series[k].band = of_curve != nullptr;
    if (of_curve == nullptr) table.chart.series[k].runs = 0;  // those at each x are others
  }
  if (draws_runs(plot)) table.chart.series = std::move(traces);
  for (Series& series : table.chart.series) {
    if (curves.size() == 1) series.title = {};
  }
  table.chart.note =
      note_of(plot, of_whole_run ? std::nullopt : std::optional(cycle), runs, with_value);
  return table;
}

/// Means of both measures at each cycle, over the runs that have both.
FigureTable against_measure(const PlotSpec& plot, std::span<const Curve> curves) {
  std::array<MeasureColumn, 2> both = {y_column(plot), column_for(plot.x)};
  both[0].known = plot.x, both[1].known = plot.y;
  FigureTable table = against_cycle(plot.name, curves, both, {});
  table.chart.series = series_of(curves, columns_against(column_name(both[1], "mean"), both[0]));
  table.chart.note.clear();  // of lines that are not drawn
  return table;
}

/// How the plot's curves are drawn, as far as it states it.
std::vector<CurveStyle> styles_of(const PlotSpec& plot) {
  std::vector<CurveStyle> styles;
  for (const SeriesSpec& one : plot.series) {
    CurveStyle& stated =
        styles.emplace_back(CurveStyle{.where = one.where, .of_manifest = !plot.listed});
    stated.title = formula(one.label);
    const auto name = std::ranges::find(colour_names, one.colour);
    stated.colour = name == colour_names.end()
                        ? one.colour
                        : safe_colours[static_cast<std::size_t>(name - colour_names.begin())];
    const auto symbol = static_cast<std::size_t>(std::ranges::find(marker_names, one.marker) -
                                                 marker_names.begin());
    if (symbol < marker_names.size()) stated.point = symbol == 0 ? 0 : curve_symbol(symbol - 1);
  }
  return styles;
}

/// Adds the published numbers in black: a dashed line, or two at the ends of an error, and points
/// with open symbols. The caption names their sources.
void add_published(const PlotSpec& plot, Chart& chart) {
  std::vector<std::string> sources;
  int point = 6;
  for (const PublishedSpec& one : plot.published) {
    Series series{.title = formula(one.label), .colour = "#000000", .point = point};
    if (one.value) {
      series.point = 0;
      series.join = Join::dashes;
      for (const double end : {-one.error, one.error}) {
        if (end != 0 || chart.lines.empty() || chart.lines.back().at != *one.value) {
          chart.lines.push_back({.at = *one.value + end, .colour = "#000000"});
        }
      }
    } else {
      point = point == 12 ? 4 : point + 2;
    }
    for (const std::vector<double>& p : one.points) {
      series.points.push_back({p[0], p[1]});
      if (p.size() > 2) series.points.back().y_error = p[2];
    }
    chart.series.push_back(std::move(series));
    const std::string value = !one.value       ? ""
                              : one.error == 0 ? fmt::format(" {}", *one.value)
                                               : fmt::format(" {} ± {}", *one.value, one.error);
    sources.push_back(fmt::format("{}{}: {}", plain_text(formula(one.label)), value, one.source));
  }
  if (!sources.empty()) chart.sources = fmt::format("Published: {}", fmt::join(sources, "; "));
}

/// Of y, and of further measures.
std::vector<MeasureColumn> columns_of(const PlotSpec& plot) {
  std::vector<MeasureColumn> columns = {y_column(plot)};
  for (const ColumnSpec& one : plot.also) columns.push_back(column_for(one.measure, one.name));
  return columns;
}

FigureTable draw(const PlotSpec& plot, std::vector<FigureRun> given, const NameVariants& names) {
  if (is_measured_of_run(plot.x) && !draws_runs(plot)) average_x(plot, given);
  const Measure* measured = find_curve(plot.y);
  const bool by_parameter = measured == nullptr && is_parameter(plot.x);
  const bool grouped = by_parameter || !plot.by.empty() || !plot.panel.empty();
  const std::vector<FigureRun> groups =
      grouped ? by_curve(given, plot, names) : std::vector<FigureRun>();
  const std::vector<Curve> curves = curves_of(grouped ? groups : given, styles_of(plot));
  if (by_parameter || measured != nullptr) return against_x(plot, given, curves);
  const std::vector<MeasureColumn> columns = columns_of(plot);
  if (draws_runs(plot)) return traces(plot, curves);
  if (plot.x == "cycle") return against_cycle(plot.name, curves, columns, {});
  if (plot.x == "phi") return against_phi(plot.name, curves, columns[0], {});
  return against_measure(plot, curves);
}

/// Adds the value of the panel's parameter to each row, after the variant.
void add_panel_column(const std::string& parameter, const nlohmann::json& value,
                      FigureTable& table) {
  if (std::ranges::count(table.columns, parameter) > 0) return;
  table.columns.insert(table.columns.begin() + 1, parameter);
  for (TableRow& row : table.rows) {
    row.insert(row.begin() + 1,
               value.is_number() ? TableValue(value.get<double>()) : TableValue(value_text(value)));
  }
}

/// Gives all panels the ranges of all their data and published lines.
void share_ranges(std::vector<FigureTable>& tables) {
  std::array<double, 2> low = {infinite, infinite}, high = {-infinite, -infinite};
  for (const FigureTable& table : tables) {
    for (const Series& series : table.chart.series) {
      for (const ChartPoint& p : points_of(table, series)) {
        if (!is_on_log_axes(table.chart, p)) continue;
        const double error = table.chart.y.log ? 0 : p.y_error.value_or(0);
        low = {std::min(low[0], p.x), std::min(low[1], p.y - error)};
        high = {std::max(high[0], p.x), std::max(high[1], p.y + error)};
      }
    }
    for (const ReferenceLine& line : table.chart.lines) {
      if (!is_on_log_axes(table.chart, line)) continue;
      low[1] = std::min(low[1], line.at);
      high[1] = std::max(high[1], line.at);
    }
  }
  for (FigureTable& table : tables) {
    Axis* const axes[] = {&table.chart.x, &table.chart.y};
    for (std::size_t k = 0; k < 2; ++k) {
      if (!(low[k] < high[k])) continue;
      const double room = 0.04 * (axes[k]->log ? std::log(high[k] / low[k]) : high[k] - low[k]);
      const auto beyond = [&](double end, double by) {
        return axes[k]->log ? end * std::exp(by) : end + by;
      };
      axes[k]->low = std::min(axes[k]->low.value_or(high[k]), beyond(low[k], -room));
      axes[k]->high = beyond(high[k], room);
    }
  }
}

FigureResult plot_runs(const PlotSpec& plot, std::span<const FigureRun> given,
                       const NameVariants& names) {
  if (!plot.by.empty() && !is_measured_of_run(plot.x)) {
    std::vector<std::string> keys = names_in(plot.x);
    keys.insert(keys.end(), {plot.by, plot.panel});
    require_told_apart(plot.name, given, keys, "leave out its `by` for a curve of each variant");
  }
  std::vector<FigureRun> runs = with_values(given, {plot.y, plot.x});
  const std::string less = plot.minus.empty() ? "" : subtract(plot, runs);
  FigureResult result;
  std::vector<nlohmann::json> wheres;
  std::map<nlohmann::json, std::vector<FigureRun>> panels;  // by the value of their parameter
  for (FigureRun& run : runs) {
    const nlohmann::json value = plot.panel.empty() ? nullptr : parameter_of(run, plot.panel);
    panels[value].push_back(std::move(run));
  }
  // An empty panel, whose caption says why.
  if (panels.empty() && !less.empty()) panels[nullptr] = {};
  for (const auto& [value, members] : panels) {
    FigureTable& table = result.tables.emplace_back(draw(plot, members, names));
    table.chart.x = x_axis(plot, members);
    table.chart.y = axis_of(plot.y);
    if (!plot.minus.empty()) table.chart.y.name = Text("difference in ") + table.chart.y.name;
    if (plot.show == Show::rms) table.chart.y.name = Text("rms ") + table.chart.y.name;
    if (!less.empty()) table.chart.note += (table.chart.note.empty() ? "" : ". ") + less;
    adapt(table.chart.x, plot.xlabel, plot.log == LogAxes::x || plot.log == LogAxes::xy);
    adapt(table.chart.y, plot.ylabel, plot.log == LogAxes::y || plot.log == LogAxes::xy);
    add_published(plot, table.chart);
    if (plot.panel.empty()) continue;
    table.name += fmt::format("_{}", result.tables.size());
    const nlohmann::json where = {{plot.panel, value}};
    wheres.push_back(where);
    table.chart.title = words_of(where);
    add_panel_column(plot.panel, value, table);
  }
  if (names && !wheres.empty()) {
    const auto named = names(wheres);
    for (std::size_t k = 0; k < wheres.size(); ++k) {
      result.tables[k].chart.title = named.at(wheres[k]);
    }
  }
  if (result.tables.size() > 1) share_ranges(result.tables);
  return result;
}

/// The cycles, first to last, of which the parts need what is simulated; none: all.
std::optional<std::array<std::uint64_t, 2>> simulated_by(std::span<const Figure> parts) {
  std::optional<std::array<std::uint64_t, 2>> hull;
  for (const Figure& part : parts) {
    const bool simulates = std::ranges::any_of(part.needs, [](const std::string& name) {
      return provider(name).from == ComputedFrom::simulation;
    });
    if (!simulates) continue;
    if (!part.within) return std::nullopt;
    const auto [first, last] = *part.within;
    hull =
        hull ? std::array{std::min(hull->at(0), first), std::max(hull->at(1), last)} : *part.within;
  }
  return hull;
}

/// One figure of several: its panels and verdicts are theirs.
Figure joined(const std::string& name, const std::string& title, std::vector<Figure> parts) {
  if (parts.size() == 1 && parts.front().name == name) return std::move(parts.front());
  Figure figure{name, title.empty() ? parts.front().title : title, {}};
  figure.within = parts.front().within;
  figure.simulated = simulated_by(parts);
  for (const Figure& part : parts) {
    for (const std::string& key : part.keys) {
      if (std::ranges::find(figure.keys, key) == figure.keys.end()) figure.keys.push_back(key);
    }
    figure.needs.insert(figure.needs.end(), part.needs.begin(), part.needs.end());
    if (part.within != figure.within) figure.within = {};
  }
  if (std::ranges::all_of(parts, [](const Figure& part) { return bool(part.uses); })) {
    figure.uses = [parts](const FigureRun& run) {
      return std::ranges::any_of(parts, [&](const Figure& part) { return part.uses(run); });
    };
  }
  figure.make = [parts = std::move(parts)](std::span<const FigureRun> runs) {
    FigureResult result;
    for (const Figure& part : parts) {
      FigureResult more = part.make(runs);
      std::ranges::move(more.tables, std::back_inserter(result.tables));
      std::ranges::move(more.verdicts, std::back_inserter(result.verdicts));
    }
    return result;
  };
  return figure;
}

}  // namespace

std::string words_of(const nlohmann::json& values) {
  std::string text;
  for (const auto& [key, value] : values.items()) {
    text += (text.empty() ? "" : ", ") + key + "=" + value_text(value);
  }
  return text;
}

std::string repeated_column(const PlotSpec& plot) {
  std::set<std::string> names;
  for (const MeasureColumn& column : columns_of(plot)) {
    const std::string name = column_name(column, "mean");
    if (!names.insert(name).second) return name;
  }
  return "";
}

bool is_parameter(std::string_view axis) {
  return std::ranges::none_of(names_in(axis), [](const std::string& name) {
    return name == "cycle" || find_measure(name) != nullptr || find_curve(name) != nullptr;
  });
}

bool is_measured_of_run(std::string_view x) {
  return std::ranges::any_of(names_in(x), [](const std::string& name) {
    return find_measure(name, MeasureKind::run) != nullptr;
  });
}

std::size_t count_variants(RunGroup runs) {
  std::set<std::string> distinct;
  for (const FigureRun* run : runs) distinct.insert(run->place.variant);
  return distinct.size();
}

std::vector<const FigureRun*> runs_with(const nlohmann::json& where,
                                        std::span<const FigureRun> runs) {
  std::vector<const FigureRun*> found;
  for (const FigureRun& run : runs) {
    if (has_parameters(run, where)) found.push_back(&run);
  }
  std::vector<const FigureRun*> as_stated = found;
  std::erase_if(as_stated,
                [](const FigureRun* run) { return run->place.swept.contains("engine"); });
  return count_variants(found) > 1 && count_variants(as_stated) == 1 ? as_stated : found;
}

std::string variants_have(std::size_t variants, const nlohmann::json& where) {
  return variants == 0 ? "no variant has " + words_of(where)
                       : fmt::format("{} variants have {}", variants, words_of(where));
}

std::string problem_of_minus(const PlotSpec& plot, std::size_t variants) {
  if (plot.minus.empty() || variants == 1) return "";
  return fmt::format("{}; `minus` must name one.", variants_have(variants, plot.minus));
}

std::vector<FigureRun> with_values(std::span<const FigureRun> given,
                                   const std::vector<std::string>& texts) {
  std::vector<FigureRun> runs(given.begin(), given.end());
  for (const std::string& text : texts) {
    if (!is_expression(text) && find_measure(text, MeasureKind::run) == nullptr) continue;
    const Evaluate evaluate = evaluator_of(text);
    for (FigureRun& run : runs) {
      const auto of_run = [&run](const std::string& name) {
        const Measure* measure = find_measure(name, MeasureKind::run);
        return measure != nullptr ? measure->of_run(run).or_nan() : number_of(run, name);
      };
      if (is_parameter(text)) {
        run.parameters[text] = evaluate(of_run);
        continue;
      }
      for (CheckpointMeasures& checkpoint : run.checkpoints) {
        checkpoint.measures.numbers[text] = evaluate([&](const std::string& name) {
          if (find_measure(name) != nullptr) return checkpoint.measures.number(name);
          return name == "cycle" ? checkpoint.cycle : of_run(name);
        });
      }
    }
  }
  return runs;
}

std::vector<std::string> needs_of(const std::vector<std::string>& texts) {
  std::vector<std::string> needs;
  for (const std::string& text : texts) {
    for (const std::string& name : names_in(text)) {
      if (const Measure* one = find_plotted(name)) needs.push_back(provider_of(*one).name);
    }
  }
  return needs;
}

bool draws_every_cycle(const PlotSpec& plot) {
  return find_curve(plot.y) == nullptr && !is_parameter(plot.x);
}

Figure plot_figure(const PlotSpec& plot, const NameVariants& names) {
  const Measure* measured = find_curve(plot.y);
  const std::string x(measured == nullptr ? plot.x : measured->x);
  Figure figure{
      plot.name, plot.y + " against " + x,
      [plot, names](std::span<const FigureRun> runs) { return plot_runs(plot, runs, names); }};
  for (const SeriesSpec& one : plot.series) {
    for (const auto& [key, value] : one.where.items()) figure.keys.push_back(key);
  }
  std::vector<std::string> texts;
  for (const ColumnSpec& one : plot.also) texts.push_back(one.measure);
  texts.insert(texts.end(), {plot.x, plot.y});
  figure.needs = needs_of(texts);
  figure.within = plot.cycles;
  if (plot.cycle && !draws_every_cycle(plot) && !is_parameter(plot.y)) {
    figure.within = {{*plot.cycle, *plot.cycle}};
  }
  return figure;
}

std::vector<Figure> own_figures(std::span<const PlotSpec> plots, std::span<const ClaimSpec> claims,
                                const NameVariants& names, const std::string& question) {
  nlohmann::ordered_map<std::string, std::vector<Figure>> figures;  // their parts
  for (const PlotSpec& plot : plots) {
    figures[plot.figure.empty() ? plot.name : plot.figure].push_back(plot_figure(plot, names));
  }
  for (const ClaimSpec& claim : claims) {
    figures[claim.figure.empty() ? claim.name : claim.figure].push_back(claim_figure(claim));
  }
  std::vector<Figure> found;
  for (auto& [name, parts] : figures) found.push_back(joined(name, question, std::move(parts)));
  return found;
}

}  // namespace shearcell
