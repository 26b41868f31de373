// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/own_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/figures/curves.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

Quantity quantity_of(const ScalarMeasure& measure) {
  return [&measure](const Measures& m) { return measure.of(m); };
}

/// "phi_profile" and "", "pressure" and "Pa" of "pressure_Pa".
std::pair<std::string, std::string> name_and_unit(std::string_view measure, std::string_view of) {
  std::string name(measure);
  std::string unit(of == "%" ? "percent" : of == "1" ? "" : of == "d^2" ? "d2" : of);
  if (!unit.empty() && name.ends_with("_" + unit)) name.resize(name.size() - unit.size() - 1);
  return {name, unit};
}

MeasureColumn column_of(const ScalarMeasure& measure) {
  auto [name, unit] = name_and_unit(measure.name, measure.unit);
  return {std::move(name), std::move(unit), quantity_of(measure)};
}

Axis named_axis(std::string name, std::string_view unit) {
  std::ranges::replace(name, '_', ' ');
  return {.name = std::move(name), .unit = unit == "1" ? Text() : Text(std::string(unit))};
}

/// "largest crystallite" of "largest_crystallite".
Axis axis_of(const std::string& key) {
  if (key == "cycle") return cycle_axis();
  if (key == "phi") return phi_axis();
  if (key == "crystalline_percent") return crystalline_axis();
  if (key == "mean_overlap_d") return overlap_axis();
  if (const ScalarMeasure* measure = find_measure(key)) {
    return named_axis(column_of(*measure).name, measure->unit);
  }
  if (const CurveMeasure* measure = find_curve_measure(key)) {
    return named_axis(name_and_unit(measure->name, measure->unit).first, measure->unit);
  }
  return named_axis(key, "1");
}

/// The checkpoint at a cycle, or the last one; null if there is none.
const Measures* measures_at(const FigureRun& run, const std::optional<std::uint64_t>& cycle) {
  if (run.checkpoints.empty()) return nullptr;
  if (!cycle) return &run.checkpoints.back().measures;
  const auto found =
      std::ranges::find(run.checkpoints, static_cast<double>(*cycle), &CheckpointMeasures::cycle);
  return found == run.checkpoints.end() ? nullptr : &found->measures;
}

/// A copy of the runs in which the curve is the variant: runs that differ in `x` alone, or those
/// with one value of `by`, share a curve. It has the name of its variant where it is of one.
std::vector<FigureRun> by_curve(std::span<const FigureRun> runs, const PlotSpec& plot,
                                const NameVariants& name) {
  std::vector<std::string> keys = varied_keys(runs);
  std::erase(keys, plot.x);
  if (!plot.by.empty()) keys = {plot.by};
  std::vector<FigureRun> found(runs.begin(), runs.end());
  std::map<std::string, std::set<std::string>> names;
  for (FigureRun& run : found) {
    nlohmann::json labels = nlohmann::json::object();
    std::string text;
    for (const std::string& key : keys) {
      labels[key] = parameter_of(run, key);
      const auto& value = labels[key];
      text += (text.empty() ? "" : ", ") + key + "=" +
              (value.is_string() ? value.get<std::string>() : value.dump());
    }
    if (run.labels.is_object()) run.parameters.update(run.labels);
    run.labels = std::move(labels);
    run.variant = text.empty() ? "all" : text;
    names[run.variant].insert(run.name);
  }
  std::vector<nlohmann::json> curves;
  for (const FigureRun& run : found) {
    if (std::ranges::find(curves, run.labels) == curves.end()) curves.push_back(run.labels);
  }
  const std::vector<std::string> shared = name ? name(curves) : std::vector<std::string>();
  for (FigureRun& run : found) {
    if (names.at(run.variant).size() == 1 && !run.name.empty()) continue;
    const auto curve = std::ranges::find(curves, run.labels) - curves.begin();
    run.name = name && !run.labels.empty() ? shared[static_cast<std::size_t>(curve)] : run.variant;
  }
  return found;
}

FigureTable traces(const PlotSpec& plot, std::span<const Curve> curves, const Quantity& y,
                   const std::function<double(const FigureRun&, const CheckpointMeasures&)>& x) {
  FigureTable table{.name = plot.name, .columns = {"variant", "seed", plot.x, plot.y}, .rows = {}};
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const Curve& curve = curves[k];
    Text title = curve.style.title;  // once in the key
    for (const FigureRun* run : curve.runs) {
      Series series{.title = std::exchange(title, Text()),
                    // Without symbols, each curve has a colour of its own.
                    .colour = safe_colours[k % safe_colours.size()],
                    .point = 0,
                    .join = Join::line,
                    .thin = true};
      for (const CheckpointMeasures& c : run->checkpoints) {
        const double at = x(*run, c), value = y(c.measures);
        table.rows.push_back({curve.variant, static_cast<std::int64_t>(run->seed), at, value});
        if (std::isfinite(at) && std::isfinite(value)) series.points.push_back({at, value});
      }
      table.chart.series.push_back(std::move(series));
    }
  }
  return table;
}

FigureTable against_parameter(const PlotSpec& plot, std::span<const FigureRun> given,
                              const NameVariants& names) {
  const std::vector<FigureRun> runs = by_curve(given, plot, names);
  const MeasureColumn y = column_of(*find_measure(plot.y));
  FigureTable table{.name = plot.name, .columns = {"variant", plot.x}, .rows = {}};
  add_columns(y, table.columns);
  table.columns.emplace_back("runs");
  const std::vector<Curve> curves =
      curves_by(runs, {}, [](const FigureRun&) { return nullptr; }, {});
  std::vector<Series> seeds;
  for (const Curve& curve : curves) {
    std::map<double, std::vector<double>> values;
    std::map<std::uint64_t, std::map<double, double>> by_seed;
    for (const FigureRun* run : curve.runs) {
      const double at = number_of(*run, plot.x);
      const Measures* measures = measures_at(*run, plot.cycle);
      const double value = measures == nullptr ? std::nan("") : y.quantity(*measures);
      if (!std::isfinite(at) || !std::isfinite(value)) continue;
      values[at].push_back(value);
      by_seed[run->seed][at] = value;
    }
    Text title = curve.style.title;  // once in the key
    for (const auto& [seed, points] : by_seed) {
      seeds.push_back({.title = std::exchange(title, Text()),
                       .colour = curve.style.colour,
                       .point = curve.style.point,
                       .join = Join::line,
                       .thin = true});
      for (const auto& [at, value] : points) seeds.back().points.push_back({at, value});
    }
    for (const auto& [at, of] : values) {
      auto& row = table.rows.emplace_back(std::vector<TableValue>{curve.variant, at});
      const RunStatistics over = over_runs(of);
      add_values(over, row);
      row.emplace_back(static_cast<std::int64_t>(over.runs));
    }
  }
  table.chart.series = series_of(
      curves,
      {.x = plot.x, .y = column_name(y, "mean"), .y_error = column_name(y, "standard_error")});
  for (Series& series : table.chart.series) series.band = false;
  if (plot.traces) table.chart.series = std::move(seeds);
  if (curves.size() == 1) table.chart.series.front().title = {};
  return table;
}

/// Means of both measures over the runs at each cycle.
FigureTable against_measure(const PlotSpec& plot, std::span<const Curve> curves) {
  const MeasureColumn x = column_of(*find_measure(plot.x)), y = column_of(*find_measure(plot.y));
  const std::array<MeasureColumn, 2> both = {y, x};
  FigureTable table = against_cycle(plot.name, curves, both, {});
  table.chart.series = series_of(curves, {.x = column_name(x, "mean"),
                                          .y = column_name(y, "mean"),
                                          .y_error = column_name(y, "standard_error")});
  return table;
}

/// A measured curve of one checkpoint: its mean over the runs at each x, or each run's.
FigureTable measured_curves(const PlotSpec& plot, const CurveMeasure& measure,
                            std::span<const Curve> curves) {
  const auto [name, unit] = name_and_unit(measure.name, measure.unit);
  const MeasureColumn y{name, unit, {}};
  FigureTable table{.name = plot.name, .columns = {"variant", std::string(measure.x)}, .rows = {}};
  add_columns(y, table.columns);
  table.columns.emplace_back("runs");
  std::vector<Series> single;
  for (const Curve& curve : curves) {
    std::map<double, std::vector<double>> values;
    Text title = curve.style.title;  // once in the key
    for (const FigureRun* run : curve.runs) {
      const Measures* measures = measures_at(*run, plot.cycle);
      if (measures == nullptr) continue;
      single.push_back({.title = std::exchange(title, Text()),
                        .colour = curve.style.colour,
                        .point = 0,
                        .join = Join::line,
                        .thin = true});
      const MeasuredCurve measured = measure.of(*measures);
      for (std::size_t i = 0; i < measured.x.size(); ++i) {
        if (!std::isfinite(measured.y[i])) continue;
        values[measured.x[i]].push_back(measured.y[i]);
        single.back().points.push_back({measured.x[i], measured.y[i]});
      }
    }
    for (const auto& [x, of] : values) {
      auto& row = table.rows.emplace_back(std::vector<TableValue>{curve.variant, x});
      const RunStatistics over = over_runs(of);
      add_values(over, row);
      row.emplace_back(static_cast<std::int64_t>(over.runs));
    }
  }
  table.chart.series = series_of(curves, {.x = std::string(measure.x),
                                          .y = column_name(y, "mean"),
                                          .y_error = column_name(y, "standard_error")});
  // Hundreds of values: symbols would hide the curve.
  for (Series& series : table.chart.series) series.point = 0;
  if (plot.traces) table.chart.series = std::move(single);
  if (curves.size() == 1) table.chart.series.front().title = {};
  return table;
}

FigureTable draw(const PlotSpec& plot, std::span<const FigureRun> given,
                 const NameVariants& names) {
  const CurveMeasure* measured = find_curve_measure(plot.y);
  const bool by_parameter =
      measured == nullptr && plot.x != "cycle" && find_measure(plot.x) == nullptr;
  if (by_parameter) return against_parameter(plot, given, names);
  const std::vector<FigureRun> grouped =
      plot.by.empty() ? std::vector<FigureRun>() : by_curve(given, plot, names);
  const std::span<const FigureRun> runs = plot.by.empty() ? given : grouped;
  const std::vector<Curve> curves =
      curves_by(runs, {}, [](const FigureRun&) { return nullptr; }, {});
  if (measured != nullptr) return measured_curves(plot, *measured, curves);
  const ScalarMeasure& measure = *find_measure(plot.y);
  if (plot.traces) {
    const ScalarMeasure* x = find_measure(plot.x);
    return traces(plot, curves, quantity_of(measure),
                  [of = x == nullptr ? Quantity() : quantity_of(*x)](const FigureRun&,
                                                                     const CheckpointMeasures& c) {
                    return of ? of(c.measures) : c.cycle;
                  });
  }
  const MeasureColumn column = column_of(measure);
  if (plot.x == "cycle") return against_cycle(plot.name, curves, std::span(&column, 1), {});
  if (plot.x == "phi") return against_phi(plot.name, curves, column, {});
  return against_measure(plot, curves);
}

std::string words_of(const nlohmann::json& where) {
  std::string text;
  for (const auto& [key, value] : where.items()) {
    text += (text.empty() ? "" : ", ") + key + "=" +
            (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text;
}

/// The runs of the one variant with these parameters.
std::vector<const FigureRun*> variant_with(const ClaimSpec& claim, const nlohmann::json& where,
                                           std::span<const FigureRun> runs) {
  std::vector<const FigureRun*> found;
  std::set<std::string> variants;
  for (const FigureRun& run : runs) {
    bool fits = true;
    for (const auto& [key, value] : where.items()) fits = fits && parameter_of(run, key) == value;
    if (!fits) continue;
    found.push_back(&run);
    variants.insert(run.variant);
  }
  if (variants.size() == 1) return found;
  throw UsageError(
      fmt::format("claim {}: {} variants have {}; `between` must name one on each "
                  "side",
                  claim.name, variants.size(), words_of(where)));
}

FigureResult decide_claim(const ClaimSpec& claim, std::span<const FigureRun> runs) {
  const ScalarMeasure& measure = *find_measure(claim.compare);
  const auto first = static_cast<std::int64_t>(claim.first);
  const auto last = static_cast<std::int64_t>(claim.last);
  const Scalar scalar = first == last
                            ? at_cycle(claim.compare, quantity_of(measure), first)
                            : over_cycles(claim.compare, quantity_of(measure), first, last);
  const std::string a = words_of(claim.between[0]), b = words_of(claim.between[1]);
  const std::string text =
      claim.higher ? fmt::format("{}: {} is higher by more than {} for {} than for {}", claim.name,
                                 scalar.name, claim.margin, a, b)
                   : fmt::format("{}: {} is the same for {} and {}", claim.name, scalar.name, a, b);
  const Claimed claimed = claim.higher ? Claimed::above : Claimed::within;
  return {
      {},
      {compare({text, claim.margin, claimed}, scalar, variant_with(claim, claim.between[0], runs),
               variant_with(claim, claim.between[1], runs))}};
}

}  // namespace

bool is_measure(std::string_view name) {
  return find_measure(name) != nullptr || find_curve_measure(name) != nullptr;
}

Figure plot_figure(const PlotSpec& plot, const NameVariants& names) {
  const CurveMeasure* measured = find_curve_measure(plot.y);
  const std::string x(measured == nullptr ? plot.x : measured->x);
  Figure figure{plot.name, plot.y + " against " + x, FigureNeeds::scalars,
                [plot, names, measured](std::span<const FigureRun> runs) {
                  FigureTable table = draw(plot, runs, names);
                  table.chart.x = axis_of(plot.x);
                  if (measured != nullptr) {
                    table.chart.x = named_axis(name_and_unit(measured->x, measured->x_unit).first,
                                               measured->x_unit);
                  }
                  if (!plot.x_symbol.empty()) table.chart.x = {.symbol = italic(plot.x_symbol)};
                  if (!plot.x_unit.empty()) table.chart.x.unit = plot.x_unit;
                  table.chart.y = axis_of(plot.y);
                  table.chart.x.log = plot.log_x;
                  table.chart.y.log = plot.log_y;
                  if (plot.log_x) table.chart.x.low = {};
                  if (plot.log_y) table.chart.y.low = {};
                  return FigureResult{{std::move(table)}, {}};
                }};
  if (measured != nullptr) figure.derived.emplace_back(measured->derived);
  for (const std::string& name : {plot.x, plot.y}) {
    if (const ScalarMeasure* one = find_measure(name)) figure.derived.emplace_back(one->derived());
  }
  figure.within = plot.cycles;
  if (!plot.by.empty()) {
    figure.form = FigureForm::groups;
    figure.keys = {plot.by, x};
  }
  return figure;
}

Figure claim_figure(const ClaimSpec& claim) {
  Figure figure{claim.name, "", FigureNeeds::scalars,
                [claim](std::span<const FigureRun> runs) { return decide_claim(claim, runs); }};
  figure.derived.emplace_back(find_measure(claim.compare)->derived());
  return figure;
}

}  // namespace shearcell
