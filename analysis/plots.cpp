// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a plot. The functions are in the order of the calls: select runs and checkpoints, evaluate
// the columns, group runs into panels and curves, average, draw.
#include "analysis/plots.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/estimators.hpp"
#include "analysis/styles.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

const Measure* find_curve(std::string_view name) {
  return find_measure(name, MeasureKind::curve);
}

/// The kind of quantity on the x axis. It decides which values are averaged over runs.
enum class Against { cycle, phi, measure, number_of_run, curve };

Against against(const PlotSpec& plot) {
  if (find_curve(plot.y()) != nullptr) return Against::curve;
  if (is_of_run(plot.x)) return Against::number_of_run;
  return plot.x == "cycle" ? Against::cycle : plot.x == "phi" ? Against::phi : Against::measure;
}

/// Whether the plot draws single runs instead of averages over runs.
bool draws_runs(const PlotSpec& plot) {
  return plot.show == Show::traces || plot.show == Show::scatter;
}

// --- Select ---

/// The column's value for the run at the checkpoint, minus the mean of its values for the runs in
/// Selected::partners at the same cycle.
double value_of(const NumberColumn& column, const Selected& one,
                const CheckpointMeasures* checkpoint) {
  const double own = column(*one.run, checkpoint);
  if (one.partners.empty()) return own;
  std::vector<double> values;
  for (const FrameRun* partner : one.partners) {
    const auto* same = checkpoint == nullptr ? nullptr : checkpoint_at(*partner, checkpoint->cycle);
    const bool is_there = checkpoint == nullptr || same != nullptr;
    values.push_back(is_there ? column(*partner, same) : std::nan(""));
  }
  return own - over_runs(values).mean.value_or(std::nan(""));
}

}  // namespace

PlotRuns selected_by(const PlotSpec& plot, std::span<const FrameRun> runs) {
  PlotRuns selection;
  json of_runs = plot.where;
  of_runs.erase("cycle");
  if (!plot.minus.empty()) selection.subtracted = runs_with(plot.minus, runs);
  const PackingGroups packings = by_packing(selection.subtracted);
  const std::set<std::string_view> subtracted = stage_ids(selection.subtracted);
  const NumberColumn y(plot.y());
  for (const FrameRun* run : all_runs_with(of_runs, runs)) {
    if (subtracted.contains(run->stage.id)) continue;
    const auto same = packings.find(packing_of(*run));
    if (!plot.minus.empty() && same == packings.end()) {
      selection.alone.push_back(run);
      continue;
    }
    Selected& one = selection.drawn.emplace_back(Selected{run});
    if (same != packings.end()) one.partners = same->second;
    const auto has_partner = [&](const CheckpointMeasures& checkpoint) {
      return std::ranges::any_of(one.partners, [&](const FrameRun* partner) {
        const CheckpointMeasures* other = checkpoint_at(*partner, checkpoint.cycle);
        return other != nullptr && std::isfinite(y(*partner, other));
      });
    };
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      const bool wanted =
          !plot.where.contains("cycle") || is_within(checkpoint.cycle, plot.where.at("cycle"));
      const bool alone = !plot.minus.empty() && !is_of_run(plot.y()) && !has_partner(checkpoint);
      if (wanted && !alone) one.checkpoints.push_back(&checkpoint);
    }
  }
  return selection;
}

std::string averaged_by(const PlotSpec& plot, RunGroup runs) {
  if (plot.by.empty() || is_measured_of_run(plot.x)) return "";
  std::vector<std::string> keys = names_in(plot.x);
  keys.insert(keys.end(), {plot.by, plot.panel});
  return averaged_key(runs, keys);
}

namespace {

/// The runs that the plot draws. If the caption must explain PlotSpec::minus, sets `note` to this
/// explanation. Throws UsageError if a curve would average over a swept key, or if several variants
/// would be subtracted.
std::vector<Selected> select(const PlotSpec& plot, const Frame& frame, std::string& note) {
  PlotRuns selection = selected_by(plot, frame.runs);
  const auto& [drawn, subtracted, alone] = selection;
  const std::size_t variants = count_variants(subtracted);
  if (variants > 1 && !plot.listed) {
    throw UsageError(fmt::format("plot {}: {}", plot.name, problem_of_minus(plot, variants)));
  }
  if (!problem_of_minus(plot, variants).empty()) {
    note = fmt::format("{} {}", variants == 0 ? "No run has" : "Several variants have",
                       words_of(plot.minus));
    return {};
  }
  const std::vector<const FrameRun*> runs = runs_of(drawn);
  require_told_apart(plot.name, runs, averaged_by(plot, runs),
                     "remove the key `by` of the plot to draw a curve for each variant");
  if (!plot.minus.empty()) {
    const std::string& name = subtracted.front()->name;
    note = fmt::format("Differences from {} with the same packing{}",
                       name.empty() ? words_of(plot.minus) : name,
                       alone.empty() ? ""
                                     : fmt::format("; {} of {} runs have no run to subtract",
                                                   alone.size(), alone.size() + drawn.size()));
  }
  return std::move(selection.drawn);
}

/// The cycle of the plot: PlotSpec::cycle, or the last cycle that all runs have.
double cycle_of(const PlotSpec& plot, std::span<const Selected> runs) {
  if (plot.cycle) return static_cast<double>(*plot.cycle);
  std::map<double, std::size_t> count;  // number of runs with this cycle
  std::size_t begun = 0;
  for (const Selected& run : runs) {
    if (!run.checkpoints.empty()) ++begun;
    for (const CheckpointMeasures* checkpoint : run.checkpoints) ++count[checkpoint->cycle];
  }
  const auto last = std::find_if(count.rbegin(), count.rend(),
                                 [&](const auto& cycle) { return cycle.second == begun; });
  return last == count.rend() ? infinite : last->first;
}

// --- Evaluate ---

/// x and y of one row of the frame.
struct Sample {
  double cycle = 0;
  double x = 0;
  std::vector<double> y = {};  ///< values of the columns in columns_of()
};

struct Trace : Selected {
  std::vector<Sample> samples = {};  ///< in the order of the checkpoints
  /// For each column: its RunValue if it is a measure of the whole run.
  std::vector<RunValue> of_run = {};
};

/// Runs that are drawn as one curve.
struct Curve {
  json key;             ///< the keys that distinguish curves, and their values in this curve
  std::string variant;  ///< `key` as text; set_curves() replaces ',' by ';'
  std::vector<Trace> traces = {};
  std::size_t style = 0;  ///< index in PlotSpec::series; series.size() if there is no style
  Text title = {};
  Look look = {};
};

/// A panel before it is drawn.
struct Panel {
  const PlotSpec& plot;
  std::vector<Selected> selected;
  double cycle = 0;  ///< cycle_of()
  std::vector<Curve> curves = {};
};

/// Computes the samples of a run. `columns`: PlotSpec::columns. `cycle`: cycle_of(), used if the
/// plot draws one cycle.
void evaluate(const PlotSpec& plot, std::span<const NumberColumn> columns, const NumberColumn& x,
              double cycle, Trace& trace) {
  const auto at = std::ranges::find(trace.checkpoints, cycle, &CheckpointMeasures::cycle);
  const CheckpointMeasures* chosen = at == trace.checkpoints.end() ? nullptr : *at;
  const auto add = [&](double cycle_of_row, double x_value, const CheckpointMeasures* checkpoint) {
    Sample& sample = trace.samples.emplace_back(Sample{cycle_of_row, x_value});
    for (const NumberColumn& column : columns.first(plot.drawn)) {
      sample.y.push_back(value_of(column, trace, checkpoint));
    }
    const CheckpointMeasures* row = checkpoint;
    if (row == nullptr && !trace.checkpoints.empty()) row = trace.checkpoints.front();
    for (const NumberColumn& column : columns.subspan(plot.drawn)) {
      sample.y.push_back(column(*trace.run, row));
    }
  };
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const std::string& measure = plot.columns[k].measure;
    const bool of_run = is_of_run(measure) && is_measured_of_run(measure);
    trace.of_run.push_back(of_run ? columns[k].of_run(*trace.run) : RunValue{});
    if (!trace.partners.empty()) trace.of_run.back().above = std::nan("");
  }
  switch (against(plot)) {
    case Against::curve:
      if (chosen == nullptr) break;
      if (const auto found = chosen->measures.curves.find(plot.y());
          found != chosen->measures.curves.end()) {
        const auto& [xs, ys] = found->second;
        for (std::size_t i = 0; i < xs.size(); ++i) {
          trace.samples.push_back({cycle, xs[i], {ys[i]}});
        }
      }
      break;
    case Against::number_of_run:
      if (is_of_run(plot.y())) chosen = nullptr;
      if (is_of_run(plot.y()) || chosen != nullptr) add(cycle, x(*trace.run), chosen);
      break;
    default:
      for (const CheckpointMeasures* checkpoint : trace.checkpoints) {
        const bool whole = checkpoint->cycle == std::floor(checkpoint->cycle);
        if (!draws_runs(plot) && !whole) continue;
        add(checkpoint->cycle, x(*trace.run, checkpoint), checkpoint);
      }
  }
}

/// Replaces x, a measure of the whole run, by the mean of x over the runs of the variant, so that
/// all these runs are drawn as one point. The mean includes only runs that have a y.
void average_x(std::vector<Curve>& curves) {
  std::map<std::string, std::vector<double>> found;  // x of each variant
  const auto for_each_sample = [&](const auto& visit) {
    for (Curve& curve : curves) {
      for (Trace& trace : curve.traces) {
        for (Sample& sample : trace.samples) visit(found[trace.run->place.variant], sample);
      }
    }
  };
  for_each_sample([](std::vector<double>& of_variant, const Sample& sample) {
    if (std::isfinite(sample.y.front())) of_variant.push_back(sample.x);
  });
  for_each_sample([](const std::vector<double>& of_variant, Sample& sample) {
    sample.x = over_runs(of_variant).mean.value_or(std::nan(""));
  });
}

// --- Group ---

/// The curves of a panel. If PlotSpec::by is set, each value of `by` gets a curve. Otherwise each
/// variant gets a curve. If PlotSpec::panel is set or x has one value per run, the parameter of the
/// panel and the parameters in x do not distinguish curves.
std::vector<Curve> curves_of(const PlotSpec& plot, std::span<const Selected> runs) {
  const bool by_variant =
      against(plot) != Against::number_of_run && plot.by.empty() && plot.panel.empty();
  std::vector<std::string> keys = varied_keys(swept_of(runs_of(runs)), plot.x);
  for (const std::string& used : names_in(plot.x)) std::erase(keys, used);
  std::erase(keys, plot.panel);
  if (!plot.by.empty()) keys = {plot.by};
  std::map<std::string, Curve> by_text;
  for (const Selected& one : runs) {
    json key = json::object();
    for (const std::string& name : keys) {
      if (json value = parameter_of(*one.run, name); !value.is_null()) key[name] = value;
    }
    if (by_variant) key = one.run->place.swept;
    std::string text = by_variant ? one.run->place.variant : key.empty() ? "all" : words_of(key);
    by_text.try_emplace(text, Curve{std::move(key), text}).first->second.traces.push_back({one});
  }
  std::vector<Curve> curves;
  for (auto& [text, curve] : by_text) curves.push_back(std::move(curve));
  return curves;
}

/// Sets the title of each curve. In a plot without panels, a curve whose runs all belong to one
/// named variant gets the name of this variant. Other curves get a title made from Curve::key.
void set_titles(const PlotSpec& plot, const NameVariants& name, std::span<Curve> curves) {
  std::vector<json> keys;
  for (const Curve& curve : curves) keys.push_back(curve.key);
  const auto shared = name ? name(keys) : std::map<json, std::string>();
  for (Curve& curve : curves) {
    const std::string of_variant = plot.panel.empty() ? shared_name(runs_of(curve.traces)) : "";
    curve.title = !of_variant.empty()          ? of_variant
                  : name && !curve.key.empty() ? shared.at(curve.key)
                                               : curve.variant;
  }
}

/// Sets Curve::style to the first entry of PlotSpec::series that matches the curve. A curve gets no
/// style if no entry matches it, or if another curve has the same first matching entry. With
/// PlotSpec::listed, styles are used only if PlotSpec::series contains every parameter in which the
/// curves differ.
void set_styles(const PlotSpec& plot, std::span<Curve> curves) {
  std::vector<json> keys;
  for (const Curve& curve : curves) keys.push_back(curve.key);
  const bool used = !plot.listed || std::ranges::all_of(varied_keys(keys), [&](const auto& key) {
    return std::ranges::any_of(plot.series,
                               [&](const SeriesSpec& one) { return one.where.contains(key); });
  });
  std::vector<std::size_t> count(plot.series.size() + 1);  // number of curves by Curve::style
  for (Curve& curve : curves) {
    const auto style = std::ranges::find_if(plot.series, [&](const SeriesSpec& one) {
      return used && one.column.empty() && has_parameters(*curve.traces.front().run, one.where);
    });
    curve.style = static_cast<std::size_t>(style - plot.series.begin());
    ++count[curve.style];
  }
  for (Curve& curve : curves) {
    if (count[curve.style] > 1) curve.style = plot.series.size();
  }
}

/// Sets the colour and symbol that are given in the series entry.
void set_look(const SeriesSpec& stated, std::string& colour, int& point) {
  if (!stated.colour.empty()) colour = stated.colour;
  const auto name = std::ranges::find(colour_names, stated.colour) - colour_names.begin();
  if (name < std::ssize(colour_names)) colour = safe_colours[static_cast<std::size_t>(name)];
  const auto symbol = std::ranges::find(marker_names, stated.marker) - marker_names.begin();
  if (symbol == 0)
    point = 0;
  else if (symbol < std::ssize(marker_names))
    point = curve_symbol(static_cast<std::size_t>(symbol) - 1);
}

/// The colours and symbols that are given in the manifest: first those of this plot, then those of
/// the manifest's other plots. A colour is left out if it is given in a plot earlier in this order.
std::vector<StatedLook> stated_looks(const PlotSpec& plot, const Plots& others) {
  std::vector<StatedLook> looks;
  std::set<std::string> taken;  // colours that the manifest gives in earlier plots
  const auto add = [&](const PlotSpec& from) {
    for (const SeriesSpec& one : from.series) {
      if (!one.column.empty()) continue;
      StatedLook& look = looks.emplace_back(StatedLook{one.where});
      set_look(one, look.colour, look.point);
      if (taken.contains(look.colour)) look.colour.clear();
    }
    for (const StatedLook& look : looks) taken.insert(look.colour);
  };
  if (plot.listed) return looks;
  add(plot);
  if (others != nullptr) std::ranges::for_each(*others, add);
  return looks;
}

/// Sets Panel::curves, sorted by Curve::style, then by the values in Curve::key.
void set_curves(const Looks& looks, const NameVariants& names, Panel& panel) {
  const PlotSpec& plot = panel.plot;
  std::vector<NumberColumn> columns;
  for (const ColumnSpec& one : plot.columns) columns.emplace_back(one.measure);
  const NumberColumn x(plot.x);
  panel.curves = curves_of(plot, panel.selected);
  set_titles(plot, names, panel.curves);
  set_styles(plot, panel.curves);
  std::erase_if(panel.curves, [](const Curve& curve) {
    return std::ranges::all_of(curve.traces,
                               [](const Trace& one) { return one.checkpoints.empty(); });
  });
  for (Curve& curve : panel.curves) {
    for (Trace& trace : curve.traces) evaluate(plot, columns, x, panel.cycle, trace);
    curve.look = looks.of(runs_of(curve.traces), curve.key);
    std::ranges::replace(curve.variant, ',', ';');  // some readers of CSV do not know quotes
    if (curve.style == plot.series.size()) continue;
    const SeriesSpec& stated = plot.series[curve.style];
    const bool keeps_name = plot.listed && curve.traces.front().run->named;
    if (!stated.label.empty() && !keeps_name) curve.title = formula(stated.label);
    if (!stated.colour.empty()) curve.look.join = Join::line;
    set_look(stated, curve.look.colour, curve.look.point);
  }
  std::ranges::stable_sort(panel.curves, {}, [](const Curve& curve) {
    return std::pair(curve.style, std::vector<json>(curve.key.begin(), curve.key.end()));
  });
  if (is_measured_of_run(plot.x) && !draws_runs(plot)) average_x(panel.curves);
}

// --- Average ---

/// A quantity with the columns NAME_mean_UNIT (or NAME_rms_UNIT) and NAME_standard_error_UNIT.
struct MeasureColumn {
  std::string name;
  std::string unit = {};  ///< as in column names: "d", "percent" or ""
  bool rms = false;       ///< root mean square over runs instead of the mean
};

/// Name of the column for `statistic`, which is "mean" or "standard_error".
std::string column_name(const MeasureColumn& measure, std::string_view statistic) {
  if (measure.rms && statistic == "mean") statistic = "rms";
  return fmt::format("{}_{}{}{}", measure.name, statistic, measure.unit.empty() ? "" : "_",
                     measure.unit);
}

/// Splits a measure's name: "deviator_Pa" is the column "deviator" with the unit "Pa".
MeasureColumn column_of(std::string_view measure, std::string_view of) {
  std::string name(measure);
  std::string unit(of == "%" ? "percent" : of == "1" ? "" : of);
  if (unit.starts_with("1/")) unit.replace(0, 2, "per_");
  boost::replace_first(unit, "/", "_per_");  // "m/s"
  std::ranges::replace(unit, ' ', '_');
  std::erase(unit, '^');
  if (!unit.empty() && name.ends_with("_" + unit)) name.resize(name.size() - unit.size() - 1);
  return {std::move(name), std::move(unit)};
}

/// Finds a measure of checkpoints (a number or a curve) or of whole runs; null if no measure fits.
const Measure* find_plotted(std::string_view text) {
  const Measure* measure = find_measure(text);
  if (measure == nullptr) measure = find_measure(text, MeasureKind::run);
  return measure != nullptr ? measure : find_curve(text);
}

/// The column of a measure or an expression. If `name` is not "", it replaces the column's name.
MeasureColumn column_for(const std::string& text, const std::string& name = {}) {
  MeasureColumn column = {is_expression(text) ? "(" + text + ")" : text};
  if (const Measure* measure = find_plotted(text)) column = column_of(text, measure->unit);
  if (!name.empty()) column.name = name;
  return column;
}

std::vector<MeasureColumn> columns_of(const PlotSpec& plot) {
  std::vector<MeasureColumn> columns;
  for (const auto& [measure, name] : plot.columns) columns.push_back(column_for(measure, name));
  for (MeasureColumn& column : std::span(columns).first(plot.drawn)) {
    if (!plot.minus.empty()) column.name += "_difference";
    column.rms = plot.show == Show::rms;
  }
  return columns;
}

/// Mean or root mean square over packings. If some of the values are censored, always the mean.
/// RunStatistics::runs counts all packings, also those with censored values.
RunStatistics statistics_of(RunGroup runs, std::span<const CensoredValue> values,
                            bool rms = false) {
  const std::vector<CensoredValue> means = over_packings(runs, values);
  if (std::ranges::none_of(means, &CensoredValue::censored)) {
    std::vector<double> known;
    for (const CensoredValue& mean : means) known.push_back(mean.value);
    return rms ? rms_over_runs(known) : over_runs(known);
  }
  const std::optional<Estimate> estimate = censored_mean(means);
  if (!estimate || !std::isfinite(estimate->value)) return {};
  const auto n = static_cast<double>(means.size());
  return {means.size(), estimate->value, estimate->spread / std::sqrt(n)};
}

/// Means over the runs of one curve, for one cycle, one bin of phi, or one x.
struct Bin {
  double at = 0;  ///< depends on the plot: cycle, lower end of the bin of phi, or x
  RunStatistics x = {};
  std::vector<RunStatistics> y = {};            ///< one entry for each column
  std::size_t values = 0;                       ///< runs with a y
  std::map<Missing, std::size_t> missing = {};  ///< number of runs without a y, by reason
};

/// Averages over independent runs. Runs of one packing count as one run. In a bin of phi, the value
/// of a run is the mean over its checkpoints in the bin. `columns`: the columns of Sample::y.
std::vector<Bin> average(const PlotSpec& plot, const Curve& curve,
                         std::span<const MeasureColumn> columns) {
  const Against what = against(plot);
  const bool by_cycle = what == Against::cycle || what == Against::measure;
  struct Members {
    std::vector<const FrameRun*> runs;
    std::vector<std::vector<CensoredValue>> values;  // for each run: x, then all y
    std::map<Missing, std::size_t> missing;
  };
  std::map<double, Members> bins;
  const auto is_known = [](const CensoredValue& one) {
    return !one.censored && std::isfinite(one.value);
  };
  for (const Trace& trace : curve.traces) {
    std::map<double, std::vector<Sample>> own;
    for (const Sample& sample : trace.samples) {
      if (by_cycle) own[sample.cycle].push_back(sample);
      if (by_cycle || !std::isfinite(sample.x)) continue;
      if (what == Against::phi) {
        own[std::floor(sample.x / phi_bin)].push_back(sample);
        continue;
      }
      const bool has_y = std::isfinite(sample.y.front());
      const Missing why = trace.of_run.front().missing;
      if (!has_y && why != Missing::nothing) ++bins[sample.x].missing[why];
      // A run without y still counts in the means of the other columns.
      if (has_y || why != Missing::nothing) own[sample.x].push_back(sample);
    }
    for (const auto& [at, samples] : own) {
      if (samples.size() > 1 && by_cycle) {
        throw AnalysisError(
            fmt::format("run {} has two checkpoints of cycle {}", trace.run->stage.id, at));
      }
      std::vector<CensoredValue> values;
      const auto add_mean = [&](const auto& value, double above = std::nan("")) {
        std::vector<double> all;
        for (const Sample& sample : samples) all.push_back(value(sample));
        const double mean = over_runs(all).mean.value_or(std::nan(""));
        values.push_back(std::isnan(above) ? CensoredValue{mean} : CensoredValue{above, true});
      };
      add_mean([](const Sample& sample) { return sample.x; });
      for (std::size_t k = 0; k < columns.size(); ++k) {
        add_mean([k](const Sample& sample) { return sample.y[k]; }, trace.of_run[k].above);
      }
      const bool both = is_known(values[0]) && is_known(values[1]);
      if (what == Against::phi && !both) continue;
      Members& bin = bins[at];
      // If x is a measure of checkpoints, only runs that have x and y are averaged.
      if (what == Against::measure && !both) continue;
      bin.runs.push_back(trace.run);
      bin.values.push_back(std::move(values));
    }
  }
  std::vector<Bin> found;
  for (const auto& [at, members] : bins) {
    Bin& bin = found.emplace_back(Bin{at});
    const auto over = [&](std::size_t k, bool rms) {
      std::vector<CensoredValue> values;
      for (const auto& of_run : members.values) values.push_back(of_run[k]);
      return statistics_of(members.runs, values, rms);
    };
    bin.x = over(0, false);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      bin.y.push_back(over(k + 1, columns[k].rms));
    }
    bin.values = static_cast<std::size_t>(std::ranges::count_if(
        members.values, is_known, [](const auto& of_run) { return of_run[1]; }));
    bin.missing = members.missing;
  }
  return found;
}

// --- Draw ---

/// The axis of a measure. Its name is the measure's name with spaces: "largest crystallite". A unit
/// at the end of the measure's name becomes the unit of the axis.
Axis named_axis(std::string_view measure, std::string_view unit) {
  std::string name = column_of(measure, unit).name;
  const bool has_unit = name.size() < measure.size();
  std::ranges::replace(name, '_', ' ');
  if (!has_unit) return {.name = std::move(name)};
  return {.name = std::move(name), .unit = boost::replace_all_copy(std::string(unit), "^2", "²")};
}

}  // namespace

Axis axis_of(const std::string& column) {
  static const std::map<std::string, Axis> known = {
      {"cycle", {.name = "shear cycle", .symbol = formula("$n$"), .whole = true}},
      {"phi", {.name = "volume fraction", .symbol = formula("$ϕ$")}},
      {"crystalline_percent", {.name = "percentage crystalline", .unit = "%", .low = 0}},
      {"mean_overlap_d",
       {.name = "mean overlap", .symbol = formula("⟨$δ$⟩"), .unit = formula("$d$")}}};
  if (const auto found = known.find(column); found != known.end()) return found->second;
  if (const Measure* measure = find_plotted(column)) return named_axis(column, measure->unit);
  return is_expression(column) ? Axis{.name = column} : named_axis(column, "1");
}

namespace {

/// "cycle" if all runs are sheared, "step" if all are stiffened, otherwise "cycle or step".
std::string_view word_for_cycle(std::span<const Selected> runs) {
  const auto stiffens = [](const Selected& one) {
    return !one.checkpoints.empty() &&
           std::isfinite(one.checkpoints.front()->measures.number("raised_stiffness_N_per_m"));
  };
  if (std::ranges::none_of(runs, stiffens)) return "cycle";
  return std::ranges::all_of(runs, stiffens) ? "step" : "cycle or step";
}

/// Sets the scale and the text of an axis. A logarithmic axis has no fixed lower end.
void adapt(Axis& axis, const std::string& label, bool log) {
  axis.log = log;
  if (log) axis.low = {};
  if (label.empty()) return;
  axis.name = formula(label);
  axis.symbol = axis.unit = {};
}

Axis x_axis(const PlotSpec& plot, std::span<const Selected> runs) {
  if (const Measure* y = find_curve(plot.y())) return named_axis(y->x, y->x_unit);
  if (!plot.x_symbol.empty()) {
    return {.symbol = formula("$" + plot.x_symbol + "$"), .unit = formula(plot.x_unit)};
  }
  if (!plot.x_unit.empty()) return named_axis(plot.x, plot.x_unit);
  const std::string_view word = word_for_cycle(runs);
  if (plot.x != "cycle" || word == "cycle") return axis_of(plot.x);
  return {.name = fmt::format("{} of the stiffening", word), .whole = true};
}

/// A series with the title and look of the curve, but without data points.
Series series_of(const Curve& curve) {
  return {.title = curve.title,
          .colour = curve.look.colour,
          .point = curve.look.point,
          .join = Join::line,
          .variant = curve.variant};
}

/// Removes the symbols of a curve, since symbols at every point would hide the line.
void leave_out_symbol(const Curve& curve, Series& series) {
  series.point = 0;
  series.join = curve.look.join;
}

/// If the plot draws several columns, sets title and style of the series for column k of a curve.
/// `alone`: the panel has one curve.
void name_y(const PlotSpec& plot, std::size_t k, bool alone, Series& series) {
  if (plot.drawn == 1) return;
  const auto& [measure, name] = plot.columns[k];
  // In a panel with one curve, the columns differ in colour and symbol. In a panel with several
  // curves, the columns of one curve differ only in symbol.
  if (alone) {
    series.colour = safe_colours[k % safe_colours.size()];
    series.point = curve_symbol(k);
  } else if (series.point > 0 && k % 2 == 1) {
    series.point ^= 1;  // open instead of filled, or filled instead of open
  }
  const Axis axis = axis_of(measure);
  Text label = !axis.symbol.empty() ? axis.symbol
               : name.empty()       ? axis.name
                                    : formula(boost::replace_all_copy(name, "_", " "));
  const auto stated = std::ranges::find(plot.series, name, &SeriesSpec::column);
  if (stated != plot.series.end() && !name.empty()) {
    if (!stated->label.empty()) label = formula(stated->label);
    if (alone) set_look(*stated, series.colour, series.point);
  }
  series.title = alone ? label : series.title + Text(", ") + label;
}

/// A thin line or a cloud of points for each run, for column k of y. If x has one value per run,
/// the runs of one seed share a line or cloud. Only the first line or cloud of a curve has a title.
void add_runs(const Panel& panel, const Curve& curve, std::size_t k, std::vector<Series>& all) {
  const PlotSpec& plot = panel.plot;
  const bool of_run = against(plot) == Against::number_of_run, alone = panel.curves.size() == 1;
  std::map<std::uint64_t, std::vector<ChartPoint>> lines;
  for (std::uint64_t i = 0; i < curve.traces.size(); ++i) {
    const Trace& trace = curve.traces[i];
    std::vector<ChartPoint>& points = lines[of_run ? trace.run->place.seed : i];
    for (const Sample& sample : trace.samples) {
      const double y = sample.y[k];
      if (std::isfinite(sample.x) && std::isfinite(y)) points.push_back({sample.x, y});
    }
  }
  if (!draws_every_cycle(plot)) {
    std::erase_if(lines, [](const auto& line) { return line.second.empty(); });
  }
  Series series = series_of(curve);
  series.thin = true;
  name_y(plot, k, alone, series);
  if (plot.show == Show::scatter) {
    series.join = Join::none;
  } else if (!of_run && (plot.drawn == 1 || alone)) {
    leave_out_symbol(curve, series);
  }
  for (auto& [i, points] : lines) {
    if (of_run) std::ranges::sort(points, {}, &ChartPoint::x);
    all.push_back(series);
    all.back().points = std::move(points);
    series.title = {};
  }
}

std::vector<Series> series_of_runs(const Panel& panel) {
  std::vector<Series> all;
  for (const Curve& curve : panel.curves) {
    for (std::size_t k = 0; k < panel.plot.drawn; ++k) add_runs(panel, curve, k, all);
  }
  return all;
}

/// The means of column k of y, as points.
std::vector<ChartPoint> mean_points(Against what, std::span<const Bin> bins, std::size_t k) {
  std::vector<ChartPoint> points;
  for (const Bin& bin : bins) {
    const bool mean_x = what == Against::phi || what == Against::measure;
    const std::optional<double> x = mean_x ? bin.x.mean : bin.at;
    const RunStatistics& y = bin.y[k];
    if (!x || !y.mean) continue;
    ChartPoint& point = points.emplace_back(ChartPoint{*x, *y.mean});
    if (what == Against::phi) point.x_error = bin.x.standard_error;
    point.y_error = y.standard_error;
    point.runs = static_cast<double>(y.runs);
  }
  return points;
}

/// If runs end at different cycles, the mean over the remaining runs would jump. The mean therefore
/// ends where the shortest run ends, and the longer runs continue as thin lines. `mean` is of
/// column k of y. Returns whether the runs end at different cycles.
bool follow_runs(const Curve& curve, double last_cycle, std::size_t k, bool rms, Series& mean,
                 std::vector<Series>& single) {
  double first_end = infinite;
  for (const Trace& trace : curve.traces) {
    if (!trace.samples.empty()) first_end = std::min(first_end, trace.samples.back().cycle);
  }
  if (last_cycle <= first_end) return false;
  std::erase_if(mean.points, [&](const ChartPoint& point) { return point.x > first_end; });
  for (const Trace& trace : curve.traces) {
    Series line{.colour = mean.colour, .point = 0, .join = Join::line, .thin = true};
    for (const Sample& sample : trace.samples) {
      const double value = rms ? std::abs(sample.y[k]) : sample.y[k];
      if (sample.cycle >= first_end && std::isfinite(value)) {
        line.points.push_back({sample.cycle, value});
      }
    }
    if (line.points.size() > 1) single.push_back(std::move(line));
  }
  return true;
}

/// A column of the table of means: its name, and a function that returns its cell for a bin.
struct BinColumn {
  std::string name;
  std::function<TableCell(const Bin& bin)> cell;
};

std::vector<BinColumn> bin_columns(const Panel& panel, std::span<const MeasureColumn> columns) {
  const PlotSpec& plot = panel.plot;
  const Against what = against(plot);
  std::vector<BinColumn> all;
  const auto add = [&](std::string name, auto cell) { all.push_back({std::move(name), cell}); };
  const auto add_means = [&](const MeasureColumn& column, auto statistics) {
    add(column_name(column, "mean"), [=](const Bin& bin) { return statistics(bin).mean; });
    add(column_name(column, "standard_error"),
        [=](const Bin& bin) { return statistics(bin).standard_error; });
  };
  const auto x_of = [](const Bin& bin) { return bin.x; };
  if (what == Against::phi) {
    add("phi_low", [](const Bin& bin) { return bin.at * phi_bin; });
    add("phi_high", [](const Bin& bin) { return (bin.at + 1) * phi_bin; });
    add_means(column_for(plot.x), x_of);
  } else if (draws_every_cycle(plot)) {
    add("cycle", [](const Bin& bin) { return static_cast<std::int64_t>(bin.at); });
  } else {
    const Measure* curve = find_curve(plot.y());
    add(curve != nullptr ? std::string(curve->x) : plot.x, [](const Bin& bin) { return bin.at; });
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    add_means(columns[k], [k](const Bin& bin) { return bin.y[k]; });
  }
  if (what == Against::measure) add_means(column_for(plot.x), x_of);
  for (std::size_t k = 0; k < plot.drawn; ++k) {
    add(k == 0 ? "runs" : columns[k].name + "_runs", [k](const Bin& bin) { return bin.y[k].runs; });
  }
  if (what == Against::number_of_run && find_measure(plot.y(), MeasureKind::run) != nullptr) {
    const std::pair<const char*, Missing> reasons[] = {{"runs_ended_before", Missing::too_short},
                                                       {"runs_began_after", Missing::too_late},
                                                       {"runs_unclear", Missing::undefined}};
    for (const auto& [name, why] : reasons) {
      add(name, [why = why](const Bin& bin) {
        const auto count = bin.missing.find(why);
        return count == bin.missing.end() ? std::size_t{0} : count->second;
      });
    }
  }
  if (what == Against::curve || (what == Against::number_of_run && !is_of_run(plot.y()))) {
    add("cycle", [cycle = panel.cycle](const Bin&) { return cycle; });
  }
  return all;
}

/// The table and chart of a plot that draws each run separately. The table has one row for each
/// checkpoint of each run.
Table table_of_runs(const Panel& panel) {
  const PlotSpec& plot = panel.plot;
  Table table{.name = plot.name, .columns = {"variant", "seed"}};
  const bool x = plot.x != "cycle";
  if (x) table.columns.emplace_back("cycle");
  table.columns.emplace_back(plot.x);
  for (const auto& [measure, name] : std::span(plot.columns).first(plot.drawn)) {
    const std::string unit = column_for(measure).unit;
    const std::string column = plot.drawn == 1 || name.empty() ? measure
                               : unit.empty()                  ? name
                                                               : name + "_" + unit;
    table.columns.push_back(column + (plot.minus.empty() ? "" : "_difference"));
  }
  for (const Curve& curve : panel.curves) {
    for (const Trace& trace : curve.traces) {
      for (const Sample& sample : trace.samples) {
        TableRow& row = table.rows.emplace_back(TableRow{curve.variant, trace.run->place.seed});
        if (x) row.emplace_back(sample.cycle);
        row.emplace_back(sample.x);
        row.insert(row.end(), sample.y.begin(), sample.y.end());
      }
    }
  }
  table.chart.series = series_of_runs(panel);
  return table;
}

/// A sentence for the caption: the cycle that is drawn, or how many runs have no value.
std::string note_of(const Panel& panel, std::size_t with_value) {
  if (!is_of_run(panel.plot.y())) {
    if (!std::isfinite(panel.cycle)) return "";
    return fmt::format("At {} {}{}", word_for_cycle(panel.selected), panel.cycle,
                       panel.plot.cycle ? "" : ", the last one that all runs have recorded");
  }
  const std::size_t runs = panel.selected.size();
  std::size_t censored = 0;
  for (const Curve& curve : panel.curves) {
    censored += static_cast<std::size_t>(std::ranges::count_if(
        curve.traces, [](const Trace& trace) { return std::isfinite(trace.of_run[0].above); }));
  }
  std::string note;
  if (censored > 0) {
    add_note(note, fmt::format("{} of {} runs end before {}; the means use their censored values",
                               censored, runs, reach_of(panel.plot.y())));
  }
  if (const std::size_t without = runs - with_value - censored; without > 0) {
    add_note(note, fmt::format("{} of {} runs have no value and are left out of the means", without,
                               runs));
  }
  return note;
}

/// Throws AnalysisError if two curves have the same title.
void require_different_titles(std::span<const Curve> curves) {
  std::set<std::string> titles;
  for (const Curve& curve : curves) {
    if (titles.insert(plain_text(curve.title)).second) continue;
    throw AnalysisError(
        "two curves of a figure have the label '" + plain_text(curve.title) +
        "'; give the curves different labels, in `series` of the plot or in `labels`");
  }
}

void add_mark(const Panel& panel, Table& table) {
  const MarkSpec& mark = *panel.plot.mark;
  const NumberColumn x(mark.x), y(mark.y);
  Series series{.title = formula(mark.label), .colour = "#000000"};
  for (const Curve& curve : panel.curves) {
    const std::vector<const FrameRun*> runs = runs_of(curve.traces);
    const auto over = [&](const NumberColumn& column) {
      std::vector<CensoredValue> values;
      for (const FrameRun* run : runs) values.push_back({column(*run)});
      return statistics_of(runs, values);
    };
    const RunStatistics at = over(x), value = over(y);
    if (!at.mean || !value.mean) continue;
    series.points.push_back({*at.mean, *value.mean, {}, value.standard_error});
  }
  table.chart.series.push_back(std::move(series));
}

Table draw(const Panel& panel) {
  const PlotSpec& plot = panel.plot;
  const Against what = against(plot);
  if (draws_runs(plot) && draws_every_cycle(plot)) return table_of_runs(panel);
  require_different_titles(panel.curves);
  const std::vector<MeasureColumn> columns = columns_of(plot);
  const std::vector<BinColumn> cells = bin_columns(panel, columns);
  Table table{.name = plot.name, .columns = {"variant"}};
  for (const BinColumn& one : cells) table.columns.emplace_back(one.name);
  std::vector<Series> single;
  std::size_t with_value = 0;
  for (const Curve& curve : panel.curves) {
    const std::vector<Bin> bins = average(plot, curve, columns);
    for (const Bin& bin : bins) {
      TableRow& row = table.rows.emplace_back(TableRow{curve.variant});
      for (const BinColumn& one : cells) row.push_back(one.cell(bin));
      with_value += bin.values;
    }
    Series series = series_of(curve);
    series.band = what != Against::number_of_run;
    if (what == Against::curve) leave_out_symbol(curve, series);
    // If x has one value per run, different points come from different runs, and Series::runs
    // stays 0.
    if (what != Against::number_of_run) series.runs = by_packing(runs_of(curve.traces)).size();
    for (std::size_t k = 0; k < plot.drawn; ++k) {
      Series& drawn = table.chart.series.emplace_back(series);
      drawn.points = mean_points(what, bins, k);
      name_y(plot, k, panel.curves.size() == 1, drawn);
      if (what == Against::cycle && !bins.empty() &&
          follow_runs(curve, bins.back().at, k, columns[k].rms, drawn, single)) {
        table.chart.note = "Thin lines: single runs, after the shortest run of the curve has ended";
      }
      if (what == Against::number_of_run && !bins.empty()) {
        drawn.shift = static_cast<double>(k) * (bins.back().at - bins.front().at) / 60;
      }
    }
  }
  std::ranges::move(single, std::back_inserter(table.chart.series));
  if (plot.mark) add_mark(panel, table);
  if (draws_every_cycle(plot)) return table;
  if (draws_runs(plot)) table.chart.series = series_of_runs(panel);
  if (panel.curves.size() == 1 && plot.drawn == 1) {
    for (Series& series : table.chart.series) series.title = {};
  }
  table.chart.note = note_of(panel, with_value);
  return table;
}

/// Adds the published numbers. A value is drawn as a dashed line, or as two lines at value ± error.
/// Points have open symbols. The legend has the labels, and the caption has the sources.
void add_published(const PlotSpec& plot, Chart& chart) {
  std::vector<std::string> sources;
  int point = 6;
  for (const PublishedSpec& one : plot.published) {
    const std::string value = !one.value       ? ""
                              : one.error == 0 ? fmt::format(" {}", *one.value)
                                               : fmt::format(" {} ± {}", *one.value, one.error);
    const Text title = formula(one.label) + Text(value);
    Series series{.title = title, .colour = "#000000", .point = point};
    if (one.value) {
      series.colour = chart.lines.empty() ? "#000000" : ReferenceLine().colour;
      series.point = 0;
      series.join = Join::dashes;
      for (const double end : {-one.error, one.error}) {
        if (end != 0 || chart.lines.empty() || chart.lines.back().at != *one.value) {
          chart.lines.push_back({.at = *one.value + end, .colour = series.colour});
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
    sources.push_back(fmt::format("{}: {}", plain_text(title), one.source));
  }
  if (!sources.empty()) chart.sources = fmt::format("Published: {}", fmt::join(sources, "; "));
}

/// Adds a note to the caption if some curves look the same.
void note_equal_looks(const Panel& panel, Table& table) {
  std::set<std::tuple<std::string, int, Join>> looks;
  std::size_t titled = 0;
  for (const Series& one : table.chart.series) {
    if (one.title.empty()) continue;
    looks.emplace(one.colour, one.point, one.join);
    ++titled;
  }
  if (panel.curves.size() < 2 || looks.size() == titled) return;
  add_note(table.chart.note, "Some curves look the same, because there are more curves than styles",
           ". ");
}

/// Adds the parameter of the panel as the second column. Changes nothing if the column exists.
void add_panel_column(const std::string& parameter, const json& value, Table& table) {
  if (table.place(parameter) < table.columns.size()) return;
  table.columns.insert(table.columns.begin() + 1, parameter);
  for (TableRow& row : table.rows) {
    row.insert(row.begin() + 1,
               value.is_number() ? TableCell(value.get<double>()) : TableCell(value_text(value)));
  }
}

/// Gives all panels the same ranges, which include the data and published lines of all panels.
void share_ranges(std::vector<Table>& tables) {
  DataRange x, y;
  for (const Table& table : tables) {
    for (const Series& series : table.chart.series) {
      for (const ChartPoint& p : drawn_points(table.chart, series)) {
        const double error = table.chart.y.log ? 0 : p.y_error.value_or(0);
        x.take(p.x);
        y.take(p.y - error);
        y.take(p.y + error);
      }
    }
    for (const ReferenceLine& line : table.chart.lines) {
      if (is_drawn(table.chart, line)) y.take(line.at);
    }
  }
  for (Table& table : tables) {
    for (const auto& [axis, data] : {std::pair(&table.chart.x, x), {&table.chart.y, y}}) {
      if (!(data.low < data.high)) continue;
      axis->low = std::min(axis->low.value_or(data.high), data.beyond(-0.04, axis->log));
      axis->high = data.beyond(0.04, axis->log);
    }
  }
}

FigureResult make_plot(const PlotSpec& plot, const Frame& frame, const NameVariants& names,
                       const Plots& others) {
  std::string less;                              // the caption's note on PlotSpec::minus
  std::map<json, std::vector<Selected>> panels;  // by the value of PlotSpec::panel
  for (Selected& one : select(plot, frame, less)) {
    panels[plot.panel.empty() ? json() : parameter_of(*one.run, plot.panel)].push_back(
        std::move(one));
  }
  // An empty panel is drawn, and its caption says why it is empty.
  if (panels.empty() && !less.empty()) panels[nullptr] = {};
  std::vector<std::string> shared = names_in(plot.x);
  shared.push_back(plot.panel);
  const Looks looks(frame, stated_looks(plot, others), std::move(shared));
  FigureResult result;
  std::vector<json> wheres;
  for (const auto& [value, members] : panels) wheres.push_back({{plot.panel, value}});
  std::map<json, std::string> named;
  if (names && !plot.panel.empty()) named = names(wheres);
  for (auto& [value, members] : panels) {
    Panel panel{plot, std::move(members)};
    panel.cycle = cycle_of(plot, panel.selected);
    set_curves(looks, names, panel);
    Table& table = result.tables.emplace_back(draw(panel));
    table.chart.x = x_axis(plot, panel.selected);
    table.chart.y = axis_of(plot.y());
    if (!plot.minus.empty()) table.chart.y.name = Text("difference in ") + table.chart.y.name;
    if (plot.show == Show::rms) table.chart.y.name = Text("rms ") + table.chart.y.name;
    if (!less.empty()) add_note(table.chart.note, less, ". ");
    note_equal_looks(panel, table);
    adapt(table.chart.x, plot.xlabel, plot.log == LogAxes::x || plot.log == LogAxes::xy);
    adapt(table.chart.y, plot.ylabel, plot.log == LogAxes::y || plot.log == LogAxes::xy);
    add_published(plot, table.chart);
    if (plot.panel.empty()) continue;
    table.name += fmt::format("_{}", result.tables.size());
    const json where = {{plot.panel, value}};
    table.chart.title = names ? named.at(where) : words_of(where);
    add_panel_column(plot.panel, value, table);
  }
  if (result.tables.size() > 1) share_ranges(result.tables);
  return result;
}

/// First and last cycle at which the figures `parts` need measures of ComputedFrom::simulation.
/// Empty if such measures are needed at all cycles, or at none.
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

/// Joins figures into one figure with all their panels and verdicts.
Figure joined(const std::string& name, const std::string& title, std::vector<Figure> parts) {
  if (parts.size() == 1 && parts.front().name == name) return std::move(parts.front());
  Figure figure{name, title.empty() ? parts.front().title : title, {}};
  figure.within = parts.front().within;
  figure.simulated = simulated_by(parts);
  for (const Figure& part : parts) {
    for (const std::string& key : part.keys) {
      if (std::ranges::find(figure.keys, key) == figure.keys.end()) figure.keys.push_back(key);
    }
    figure.claims.insert(figure.claims.end(), part.claims.begin(), part.claims.end());
    figure.needs.insert(figure.needs.end(), part.needs.begin(), part.needs.end());
    if (part.within != figure.within) figure.within = {};
  }
  if (std::ranges::all_of(parts, [](const Figure& part) { return bool(part.uses); })) {
    figure.uses = [parts](const FrameRun& run) {
      return std::ranges::any_of(parts, [&](const Figure& part) { return part.uses(run); });
    };
  }
  figure.make = [parts = std::move(parts)](const Frame& frame) {
    FigureResult result;
    for (const Figure& part : parts) {
      FigureResult more = part.make(frame);
      std::ranges::move(more.tables, std::back_inserter(result.tables));
      std::ranges::move(more.verdicts, std::back_inserter(result.verdicts));
    }
    return result;
  };
  return figure;
}

}  // namespace

std::string repeated_column(const PlotSpec& plot) {
  std::set<std::string> names;
  for (const MeasureColumn& column : columns_of(plot)) {
    const std::string name = column_name(column, "mean");
    if (!names.insert(name).second) return name;
  }
  return "";
}

std::string variants_have(std::size_t variants, const nlohmann::json& where) {
  return variants == 0 ? "no variant has " + words_of(where)
                       : fmt::format("{} variants have {}", variants, words_of(where));
}

std::string problem_of_minus(const PlotSpec& plot, std::size_t variants) {
  if (plot.minus.empty() || variants == 1) return "";
  return fmt::format("{}; `minus` must select one variant.", variants_have(variants, plot.minus));
}

bool draws_every_cycle(const PlotSpec& plot) {
  return find_curve(plot.y()) == nullptr && !is_of_run(plot.x);
}

Figure plot_figure(const PlotSpec& plot, const NameVariants& names, const Plots& others) {
  const Measure* measured = find_curve(plot.y());
  const std::string x(measured == nullptr ? plot.x : measured->x);
  Figure figure{plot.name, plot.y() + " against " + x, [plot, names, others](const Frame& frame) {
                  return make_plot(plot, frame, names, others);
                }};
  for (const SeriesSpec& one : plot.series) {
    for (const auto& [key, value] : one.where.items()) figure.keys.push_back(key);
  }
  std::vector<std::string> texts = {plot.x};
  for (const ColumnSpec& one : plot.columns) texts.push_back(one.measure);
  if (plot.mark) texts.insert(texts.end(), {plot.mark->x, plot.mark->y});
  figure.needs = providers_of(texts);
  if (!plot.where.empty()) {
    json where = plot.where;
    where.erase("cycle");
    figure.uses = [where, minus = plot.minus](const FrameRun& run) {
      return has_parameters(run, where) || (!minus.empty() && has_parameters(run, minus));
    };
  }
  figure.within = plot.cycles;
  if (plot.cycle && !draws_every_cycle(plot) && !is_of_run(plot.y())) {
    figure.within = {{*plot.cycle, *plot.cycle}};
  }
  return figure;
}

std::vector<Figure> own_figures(std::span<const PlotSpec> plots, std::span<const ClaimSpec> claims,
                                const NameVariants& names, const std::string& question) {
  nlohmann::ordered_map<std::string, std::vector<Figure>> figures;  // parts of each figure
  const auto all = std::make_shared<const std::vector<PlotSpec>>(plots.begin(), plots.end());
  for (const PlotSpec& plot : plots) {
    figures[figure_of(plot)].push_back(plot_figure(plot, names, all));
  }
  for (const ClaimSpec& claim : claims) {
    figures[figure_of(claim)].push_back(claim_figure(claim));
  }
  std::vector<Figure> found;
  for (auto& [name, parts] : figures) found.push_back(joined(name, question, std::move(parts)));
  return found;
}

}  // namespace shearcell
