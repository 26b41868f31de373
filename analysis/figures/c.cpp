// SPDX-License-Identifier: GPL-3.0-or-later
// Figure C: growth of crystallites. Probability to grow minus probability to shrink against size,
// critical size against amplitude, and largest crystallite against phi. Supplement C, Figs. 4(a)
// and 4(b) of the main text.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/growth.hpp"
#include "analysis/published.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

/// Crystallites are followed over n_bin cycles, and over these to show how the result depends on
/// it.
constexpr std::array<std::int64_t, 5> cycles_to_follow = {1, 2, 5, 10, 20};

/// The counts of those runs in which some crystallite could be followed over so many cycles.
std::vector<GrowthBySize> followed(RunGroup runs, std::int64_t cycles) {
  std::vector<GrowthBySize> all;
  for (const FigureRun* run : runs) {
    GrowthBySize counts = growth_of(*run, cycles);
    if (!counts.empty()) all.push_back(std::move(counts));
  }
  return all;
}

struct AmplitudeGrowth {
  CurveStyle style;
  double amplitude;
  const PublishedAmplitude* published;
  std::vector<const FigureRun*> all_runs;
  std::vector<GrowthBySize> runs;     ///< followed over n_bin cycles
  std::optional<double> onset_cycle;  ///< median over runs
  std::optional<GrowthFit> fit;
  std::optional<Estimate> critical;          ///< interval of the fit's critical size
  std::optional<Estimate> without_vanished;  ///< the same if those that vanished are left out
  std::optional<Estimate> monotone;          ///< without an assumed curve
};

constexpr std::array<const char*, 5> amplitude_colours = {"#6a3d9a", "#000000", "#009e73",
                                                          "#0072b2", "#d55e00"};

std::vector<AmplitudeGrowth> growth_by_amplitude(std::span<const FigureRun> runs) {
  std::vector<AmplitudeGrowth> all;
  for (const auto& [amplitude, members] : runs_by(runs, "amplitude_rad")) {
    const PublishedAmplitude& published = published_nearest(amplitude);
    const std::vector<GrowthBySize> counts = followed(members, published.n_bin);
    const std::size_t k = all.size();
    all.push_back({.style = {{{"amplitude_rad", amplitude}},
                             italic("A") + fmt::format(" = {}", amplitude),
                             amplitude_colours[k % amplitude_colours.size()],
                             curve_symbol(k)},
                   .amplitude = amplitude,
                   .published = &published,
                   .all_runs = members,
                   .runs = counts,
                   .onset_cycle = median_wait(waits_for_onset(members)),
                   .fit = fit_growth(counts),
                   .critical = critical_size(counts),
                   .without_vanished = critical_size(counts, Vanished::left_out),
                   .monotone = monotone_critical_size(counts)});
  }
  return all;
}

ReferenceLine critical_line(const AmplitudeGrowth& one) {
  return {.at = one.published->critical_size,
          .colour = one.style.colour,
          .title = "the supplement's critical sizes"};
}

/// Points of fewer crystallites are not drawn. [choice]
constexpr std::size_t least_counted = 20;

/// The fitted curve. Its error is half the length of the interval.
std::vector<ChartPoint> fitted_points(const AmplitudeGrowth& one) {
  std::vector<double> sizes;
  for (double size = 1; one.fit && size <= 60; size += size < 10 ? 1 : 5) sizes.push_back(size);
  const auto estimates = fitted_delta_rho(one.runs, sizes);
  std::vector<ChartPoint> points;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    ChartPoint& at = points.emplace_back(ChartPoint{sizes[k], one.fit->delta_rho(sizes[k])});
    if (estimates[k]) {
      at.y_error = (estimates[k]->interval.high - estimates[k]->interval.low) / 2;
    }
  }
  return points;
}

/// Binned data, and the fitted curve with its band.
Chart chart_of(std::span<const AmplitudeGrowth> all) {
  Chart chart{
      .x = {.name = "crystallite size", .unit = "grains", .low = 0, .high = 60, .clip = true},
      .y = {.symbol = italic("Δρ") + " = " + italic("ρ") + subscript("g") + " − " + italic("ρ") +
                      subscript("s"),
            .low = -1.05,
            .high = 1.05,
            .clip = true},
      .lines = {{.at = 0, .title = "growth as probable as shrinking"}},
      .errors = "bars are binomial errors, bands half the length of the 90 % interval of the fit"};
  for (const AmplitudeGrowth& one : all) {
    chart.series.push_back({.colour = one.style.colour,
                            .point = 0,
                            .join = Join::line,
                            .band = true,
                            .points = fitted_points(one)});
    Series& data = chart.series.emplace_back(
        Series{.title = one.style.title, .colour = one.style.colour, .point = one.style.point});
    for (const GrowthRate& bin : growth_rates(one.runs, least_counted)) {
      data.points.push_back({bin.size, bin.delta, std::nullopt, bin.delta_error});
    }
    ReferenceLine& line = chart.lines.emplace_back(critical_line(one));
    line.vertical = line.stub = true;
  }
  return chart;
}

FigureTable rates_table(std::span<const AmplitudeGrowth> all) {
  FigureTable table{
      .name = "C",
      .columns = {"amplitude_rad", "size_grains", "grow_probability", "shrink_probability",
                  "binomial_error", "delta_rho", "delta_rho_error", "crystallites", "runs"}};
  for (const AmplitudeGrowth& one : all) {
    for (const GrowthRate& rate : growth_rates(one.runs)) {
      table.rows.push_back({one.amplitude, rate.size, rate.grow, rate.shrink, rate.grow_error,
                            rate.delta, rate.delta_error, rate.counted, one.runs.size()});
    }
  }
  table.chart = chart_of(all);
  return table;
}

/// Columns of a size, its interval and its standard error.
void add_size_columns(const std::string& name, std::vector<std::string>& columns) {
  for (const char* ending : {"", "_low", "_high", "_standard_error"}) {
    columns.push_back(name + ending + "_grains");
  }
}

/// The values of those columns; empty without an estimate.
void add_size(const std::optional<Estimate>& size, TableRow& row) {
  if (!size) {
    row.resize(row.size() + 4);
    return;
  }
  row.insert(row.end(), {size->value, size->interval.low, size->interval.high,
                         size->spread / std::sqrt(static_cast<double>(size->runs))});
}

FigureTable critical_table(std::span<const AmplitudeGrowth> all) {
  FigureTable table{.name = "C_critical_size",
                    .columns = {"amplitude_rad", "cycles_followed", "onset_median_cycle"}};
  for (const char* name : {"critical_size", "without_vanished", "monotone"}) {
    add_size_columns(name, table.columns);
  }
  table.columns.insert(table.columns.end(), {"logistic_slope", "supplement_grains", "runs"});
  for (const AmplitudeGrowth& one : all) {
    TableRow& row =
        table.rows.emplace_back(TableRow{one.amplitude, one.published->n_bin, one.onset_cycle});
    for (const auto& size : {one.critical, one.without_vanished, one.monotone}) add_size(size, row);
    row.insert(row.end(), {one.fit ? TableValue(one.fit->slope) : TableValue(),
                           one.published->critical_size, one.runs.size()});
  }
  table.chart = {.x = amplitude_axis(),
                 .y = {.name = "critical size", .unit = "grains", .low = 0},
                 .series = {{.title = "supplement",
                             .colour = "#888888",
                             .point = 6,
                             .join = Join::dashes,
                             .columns = {.x = "amplitude_rad", .y = "supplement_grains"}},
                            {.title = "simulated",
                             .colour = "#000000",
                             .point = 5,
                             .columns = {.x = "amplitude_rad",
                                         .y = "critical_size_grains",
                                         .y_error = "critical_size_standard_error_grains",
                                         .runs = "runs"}}}};
  return table;
}

/// The critical size against the number of cycles over which crystallites are followed.
FigureTable followed_table(std::span<const AmplitudeGrowth> all) {
  FigureTable table{.name = "C_followed", .columns = {"amplitude_rad", "cycles_followed"}};
  add_size_columns("critical_size", table.columns);
  table.columns.emplace_back("runs");
  table.chart = {.x = {.name = "cycles that crystallites are followed", .log = true},
                 .y = {.name = "critical size", .unit = "grains", .log = true}};
  for (const AmplitudeGrowth& one : all) {
    std::set<std::int64_t> choices(cycles_to_follow.begin(), cycles_to_follow.end());
    choices.insert(one.published->n_bin);
    for (const std::int64_t cycles : choices) {
      const std::vector<GrowthBySize> runs = followed(one.all_runs, cycles);
      TableRow& row = table.rows.emplace_back(TableRow{one.amplitude, cycles});
      std::optional<Estimate> size = critical_size(runs);
      if (size && !std::isfinite(size->interval.high - size->interval.low)) size.reset();
      add_size(size, row);
      row.emplace_back(runs.size());
    }
    table.chart.series.push_back({.title = one.style.title,
                                  .colour = one.style.colour,
                                  .point = one.style.point,
                                  .join = Join::line,
                                  .columns = {.x = "cycles_followed",
                                              .y = "critical_size_grains",
                                              .y_error = "critical_size_standard_error_grains",
                                              .runs = "runs"},
                                  .filter = {"amplitude_rad", one.amplitude}});
    table.chart.lines.push_back(critical_line(one));
  }
  return table;
}

/// Fig. 4(b) of the main text: with method 1 of section C the onset is the phi at which a curve
/// reaches its critical size. No crystallite counts as one grain, as in method 2.
FigureTable largest_table(std::span<const FigureRun> runs, std::span<const AmplitudeGrowth> all) {
  std::vector<CurveStyle> styles;
  for (const AmplitudeGrowth& one : all) styles.push_back(one.style);
  const MeasureColumn largest{"largest_crystallite", "grains", "largest_crystallite", 1};
  FigureTable table = against_phi("C_largest", curves_of(runs, styles), largest,
                                  {.name = "largest crystallite", .unit = "grains", .log = true});
  for (const AmplitudeGrowth& one : all) table.chart.lines.push_back(critical_line(one));
  return table;
}

Verdict critical_size_is_published(const AmplitudeGrowth& one) {
  const double published = one.published->critical_size;
  std::optional<Estimate> relative = one.critical;
  std::string note = fmt::format("crystallites followed over {} cycles in {} of {} runs",
                                 one.published->n_bin, one.runs.size(), one.all_runs.size());
  if (one.onset_cycle) note += fmt::format(", onset at cycle {:.3g} (median)", *one.onset_cycle);
  if (relative) {
    note += fmt::format("; {:.3g} grains", one.critical->value);
    if (one.monotone) note += fmt::format(", {} without an assumed curve", one.monotone->value);
    relative = mapped(*one.critical, [&](double size) { return size / published - 1; });
    relative->spread /= published;
  } else {
    note += one.runs.size() < least_bootstrap_runs ? "; too few runs"
                                                   : "; no size at which growth begins";
  }
  GrowthCount all;
  for (const GrowthBySize& run : one.runs) {
    for (const auto& [size, count] : run) {
      if (size > largest_size_fitted) break;
      all.shrank += count.shrank;
      all.vanished += count.vanished;
    }
  }
  note += fmt::format(
      "; {} if the {} of {} that shrink by vanishing are left out",
      one.without_vanished ? fmt::format("{:.3g}", one.without_vanished->value) : "none",
      all.vanished, all.shrank);
  Verdict verdict =
      decide({fmt::format("C: the critical size at A = {} rad is about {} grains", one.amplitude,
                          published),
              margin_critical_size},
             fmt::format("critical size, relative difference from {} grains", published), relative,
             one.runs.size(), note);
  verdict.entered = entered_with({"size", "grew", "absorbed", "shrank", "vanished"});
  for (const FigureRun* run : one.all_runs) {
    for (const auto& [size, count] : growth_of(*run, one.published->n_bin)) {
      enter(*run,
            {std::int64_t{size}, count.grew - count.absorbed, count.absorbed,
             count.shrank - count.vanished, count.vanished},
            verdict.entered);
    }
  }
  return verdict;
}

}  // namespace

FigureResult figure_c(std::span<const FigureRun> runs) {
  const std::vector<AmplitudeGrowth> all = growth_by_amplitude(runs);
  FigureResult result{
      {rates_table(all), critical_table(all), largest_table(runs, all), followed_table(all)}, {}};
  for (const AmplitudeGrowth& one : all) {
    result.verdicts.push_back(critical_size_is_published(one));
  }
  return result;
}

}  // namespace shearcell
