// SPDX-License-Identifier: GPL-3.0-or-later
// Figure C: growth of crystallites. Probability to grow minus probability to shrink versus size,
// critical size versus amplitude, and largest crystallite versus phi. Supplement C, Figs. 4(a)
// and 4(b) of the main text.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "analysis/estimators.hpp"
#include "analysis/growth.hpp"
#include "analysis/plots.hpp"
#include "analysis/styles.hpp"

namespace shearcell {
namespace {

/// Numbers of cycles over which crystallites are followed. They include the supplement's number for
/// each amplitude (n_bin). The critical size depends on the number of cycles.
std::set<std::int64_t> cycles_to_follow() {
  std::set<std::int64_t> cycles = {1, 2, 5, 10, 20};
  for (const PublishedAmplitude& one : published_amplitudes) cycles.insert(one.n_bin);
  return cycles;
}
/// Number of cycles over which crystallites are followed to compare amplitudes. [choice]: after one
/// cycle crystallites have hardly changed, and after ten cycles most have grown.
constexpr std::int64_t cycles_compared = 5;

/// Each critical size of the supplement comes from "usually 6 to 10" simulations.
constexpr std::size_t published_runs = 8;

/// Growth counts over `cycles` cycles, one entry for each packing. A packing is left out if none of
/// its crystallites could be followed.
std::vector<GrowthBySize> followed(RunGroup runs, std::int64_t cycles) {
  std::vector<GrowthBySize> all;
  for (const auto& [packing, members] : by_packing(runs)) {
    GrowthBySize counts;
    for (const FrameRun* run : members) {
      for (const auto& [size, count] : growth_of(*run, cycles)) counts[size] += count;
    }
    if (!counts.empty()) all.push_back(std::move(counts));
  }
  return all;
}

/// The critical size if crystallites with one outcome (`fate`) are left out.
std::optional<Estimate> critical_size_without(std::size_t GrowthCount::*fate,
                                              std::vector<GrowthBySize> runs) {
  for (GrowthBySize& run : runs) {
    for (auto& [size, count] : run) count.*fate = 0;
  }
  return GrowthCurve(runs).critical_size();
}

/// Growth of the crystallites over a fixed number of cycles.
struct GrowthAfter {
  std::vector<GrowthBySize> runs = {};  ///< one entry for each packing
  GrowthCurve curve{runs};
  std::optional<Estimate> critical = curve.critical_size();
};

struct AmplitudeGrowth : AmplitudeRuns {
  std::map<std::int64_t, GrowthAfter> after = {};  ///< by number of cycles (cycles_to_follow())

  /// Growth over n_bin cycles, the time for which the supplement follows a crystallite.
  const GrowthAfter& published_bin() const { return after.at(published->n_bin); }

  std::optional<double> onset_cycle = {};  ///< median over runs
  // Results for published_bin(). They are stored because each one needs a bootstrap.
  std::optional<Estimate> monotone = {}, without_absorbed = {}, without_vanished = {};
  /// 90 % interval of the critical size in repeated studies, each with `published_runs` runs.
  Interval repeated = {};
};

std::vector<AmplitudeGrowth> growth_by_amplitude(std::span<const FrameRun> runs) {
  std::vector<AmplitudeGrowth> all;
  for (const AmplitudeRuns& amplitude : by_amplitude(runs)) {
    AmplitudeGrowth& one = all.emplace_back(AmplitudeGrowth{amplitude});
    for (const std::int64_t cycles : cycles_to_follow()) {
      one.after.emplace(cycles, GrowthAfter{followed(one.runs, cycles)});
    }
    const auto& [counts, curve, critical] = one.published_bin();
    one.onset_cycle = median_wait(waits_for_onset(one.runs));
    one.monotone = curve.monotone_critical_size();
    one.without_absorbed = critical_size_without(&GrowthCount::absorbed, counts);
    one.without_vanished = critical_size_without(&GrowthCount::vanished, counts);
    one.repeated = curve.repeated_critical_size(published_runs);
  }
  return all;
}

/// Points with fewer crystallites than this are not drawn. [choice]
constexpr std::size_t least_counted = 20;

std::vector<ChartPoint> smooth_points(const AmplitudeGrowth& one) {
  std::vector<ChartPoint> points;
  for (std::int32_t size = 1; size <= 60; size += size < 10 ? 1 : 5) {
    points.push_back({.x = static_cast<double>(size),
                      .y = one.published_bin().curve.delta_rho(size),
                      .y_error = one.published_bin().curve.delta_rho_error(size)});
  }
  return points;
}

/// Draws binned data as points, and the smooth curve with its error band.
Chart chart_of(std::span<const AmplitudeGrowth> all) {
  Chart chart{
      .x = {.name = "crystallite size", .unit = "grains", .low = 0, .high = 60, .clip = true},
      .y = {.symbol = formula("$Δρ$ = $ρ_g$ − $ρ_s$"), .low = -1.05, .high = 1.05, .clip = true},
      .lines = {{.at = 0, .title = "growth as probable as shrinking"}},
      .note = fmt::format("curves are smoothed over {} in ln(size)", GrowthCurve::bandwidth)};
  for (const AmplitudeGrowth& one : all) {
    chart.series.push_back({.colour = one.look.colour,
                            .point = 0,
                            .join = Join::line,
                            .band = true,
                            .points = smooth_points(one)});
    Series& data = chart.series.emplace_back(
        Series{.title = one.title, .colour = one.look.colour, .point = one.look.point});
    for (const GrowthRate& bin : growth_rates(one.published_bin().runs, least_counted)) {
      data.points.push_back({bin.size, bin.delta, std::nullopt, bin.delta_error});
    }
    ReferenceLine& line = chart.lines.emplace_back(one.critical_line());
    line.vertical = line.stub = true;
  }
  return chart;
}

Table rates_table(std::span<const AmplitudeGrowth> all) {
  Table table{.name = "C",
              .columns = {"amplitude_rad", "size_grains", "grew", "absorbed", "shrank", "vanished",
                          "delta_rho", "delta_rho_standard_error", "runs"}};
  for (const AmplitudeGrowth& one : all) {
    for (const GrowthRate& rate : growth_rates(one.published_bin().runs)) {
      const GrowthCount& count = rate.count;
      table.rows.push_back({one.amplitude, rate.size, count.grew, count.absorbed, count.shrank,
                            count.vanished, rate.delta, rate.delta_error,
                            one.published_bin().runs.size()});
    }
  }
  table.chart = chart_of(all);
  return table;
}

Table critical_table(std::span<const AmplitudeGrowth> all) {
  Table table{.name = "C_critical_size",
              .columns = {"amplitude_rad", "cycles_followed", "onset_median_cycle"}};
  for (const char* name : {"critical_size", "monotone", "without_absorbed", "without_vanished"}) {
    add_size_columns(name, table.columns);
  }
  table.columns.insert(table.columns.end(), {"repeated_low_grains", "repeated_high_grains",
                                             "supplement_grains", "runs"});
  Series published{.title = "supplement", .colour = "#888888", .point = 6, .join = Join::dashes};
  Series simulated{.title = "simulated", .colour = "#000000", .point = 5};
  for (const AmplitudeGrowth& one : all) {
    const auto& [counts, curve, critical] = one.published_bin();
    TableRow& row =
        table.rows.emplace_back(TableRow{one.amplitude, one.published->n_bin, one.onset_cycle});
    for (const auto& size : {critical, one.monotone, one.without_absorbed, one.without_vanished}) {
      add_size(size, row);
    }
    row.insert(row.end(),
               {one.repeated.low, one.repeated.high, one.published->critical_size, counts.size()});
    published.points.push_back({one.amplitude, one.published->critical_size});
    if (!critical) continue;
    simulated.points.push_back(point_of(one.amplitude, *critical));
    simulated.points.back().runs = static_cast<double>(counts.size());
  }
  table.chart = {
      .x = {.name = "amplitude", .symbol = formula("$A$"), .unit = "rad", .low = 0, .high = 0.12},
      .y = {.name = "critical size", .unit = "grains", .low = 0},
      .series = {std::move(published), std::move(simulated)}};
  return table;
}

/// The critical size as a function of the number of cycles over which crystallites are followed.
/// The supplement's critical size is shown at n_bin, the supplement's number of cycles.
Table followed_table(std::span<const AmplitudeGrowth> all) {
  Table table{.name = "C_followed", .columns = {"amplitude_rad", "cycles_followed"}};
  add_size_columns("critical_size", table.columns);
  table.columns.insert(table.columns.end(), {"supplement_grains", "runs"});
  table.chart = {.x = {.name = "cycles followed", .log = true},
                 .y = {.name = "critical size", .unit = "grains", .log = true},
                 .note = "large open symbols are critical sizes of the supplement"};
  for (const AmplitudeGrowth& one : all) {
    Series sizes{
        .title = one.title, .colour = one.look.colour, .point = one.look.point, .join = Join::line};
    Series published{.colour = one.look.colour, .point = one.look.point - 1, .large = true};
    for (const auto& [cycles, after] : one.after) {
      const bool is_published = cycles == one.published->n_bin;
      if (after.runs.empty() && !is_published) continue;
      TableRow& row = table.rows.emplace_back(TableRow{one.amplitude, cycles});
      add_size(after.critical, row);
      row.emplace_back(is_published ? TableCell(one.published->critical_size) : TableCell());
      row.emplace_back(after.runs.size());
      const auto x = static_cast<double>(cycles);
      if (is_published) published.points.push_back({x, one.published->critical_size});
      if (!after.critical) continue;
      sizes.points.push_back(point_of(x, *after.critical));
      sizes.points.back().runs = static_cast<double>(after.runs.size());
    }
    table.chart.series.insert(table.chart.series.end(), {std::move(sizes), std::move(published)});
  }
  return table;
}

/// Fig. 4(b) of the main text. In method 1 of section C the onset is the phi at which a curve
/// reaches the critical size. A packing without crystallites is drawn with size 1, as in method 2.
Table largest_table(const Frame& frame, std::span<const AmplitudeGrowth> all) {
  PlotSpec plot{.name = "C_largest",
                .columns = {{"max(1,largest_crystallite)", "largest_crystallite"}},
                .x = "phi",
                .log = LogAxes::y,
                .ylabel = "largest crystallite [grains]"};
  for (const AmplitudeGrowth& one : all) {
    plot.series.push_back({.where = {{"amplitude_rad", one.amplitude}},
                           .label = fmt::format("$A$ = {}", one.amplitude),
                           .colour = one.look.colour});
  }
  FigureResult drawn = plot_figure(plot).make(frame);
  if (drawn.tables.empty()) return {.name = plot.name};
  Table table = std::move(drawn.tables.front());
  for (const AmplitudeGrowth& one : all) {
    table.chart.lines.push_back(one.critical_line());
  }
  return table;
}

/// For each run, the counts from which the critical size is computed.
Table growth_entered(RunGroup runs, std::int64_t cycles) {
  Table entered =
      entered_with({"cycles_followed", "size", "grew", "absorbed", "shrank", "vanished"});
  for (const FrameRun* run : runs) {
    for (const auto& [size, count] : growth_of(*run, cycles)) {
      if (size > GrowthCurve::largest) break;
      enter(*run,
            {cycles, std::int64_t{size}, count.grew, count.absorbed, count.shrank, count.vanished},
            entered);
    }
  }
  return entered;
}

std::string in_grains(double size) {
  return std::isfinite(size) ? fmt::format("{:.3g}", size) : size > 0 ? "unbounded" : "less than 1";
}

std::string in_grains(const std::optional<Estimate>& size) {
  return size ? in_grains(size->value) : "none";
}

/// The supplement's critical size comes from few runs. Its error is assumed to be the error that
/// our critical size would have with published_runs runs.
Verdict critical_size_is_published(const AmplitudeGrowth& one) {
  const auto& [counts, curve, critical] = one.published_bin();
  const double published = one.published->critical_size;
  const auto [low, high] = one.repeated;
  std::string note = fmt::format("crystallites followed over {} cycles in {} of {} runs",
                                 one.published->n_bin, counts.size(), one.runs.size());
  if (one.onset_cycle) note += fmt::format(", onset at cycle {:.3g} (median)", *one.onset_cycle);
  std::optional<Estimate> relative;
  if (critical) {
    const double size = critical->value;
    note += fmt::format("; critical size {:.3g} grains, or {} by a monotone fit of delta_rho", size,
                        in_grains(one.monotone));
    note += fmt::format("; 90 % of repeated studies with {} runs would give {} to {}",
                        published_runs, in_grains(low), in_grains(high));
    relative = relative_difference(
        critical, Estimate{.value = published,
                           .interval = {published * size / high, published * size / low},
                           .runs = critical->runs});
  } else {
    note += counts.size() < least_bootstrap_runs ? "; too few runs"
                                                 : "; no size at which growth begins";
  }
  GrowthCount all;
  for (const GrowthBySize& of_packing : counts) {
    for (const auto& [size, count] : of_packing) {
      if (size <= GrowthCurve::largest) all += count;
    }
  }
  note += fmt::format(
      "; critical size {} if absorbed crystallites ({} of {} that grow) are left out, and {} if "
      "vanished crystallites ({} of {} that shrink) are left out",
      in_grains(one.without_absorbed), all.absorbed, all.larger(), in_grains(one.without_vanished),
      all.vanished, all.smaller());
  Verdict verdict = decide(
      {.text = fmt::format("C: the critical size at A = {} rad is about {} grains", one.amplitude,
                           published),
       .margin = margin_critical_size,
       .id = fmt::format("C.critical_size@amplitude_rad={}", one.amplitude),
       .cannot_be_decided =
           one.published->amplitude_rad == one.amplitude ? one.published->cannot_be_decided : ""},
      fmt::format("critical size, relative difference from {} grains", published), relative,
      counts.size(), note, growth_entered(one.runs, one.published->n_bin));
  if (critical && !(low > 0 && high / low <= 1 + 2 * margin_critical_size)) {
    // No number of runs suffices: the sampling error of the supplement's value exceeds the margin.
    verdict.runs_needed.reset();
  }
  return verdict;
}

/// Considers the amplitudes that have a critical size after cycles_compared cycles. Compares the
/// critical sizes at the largest and at the smallest of these amplitudes. Runs of different
/// amplitudes are treated as independent.
Verdict critical_size_grows(std::span<const AmplitudeGrowth> all) {
  std::vector<const AmplitudeGrowth*> sized;
  std::string note = fmt::format("crystallites followed over {} cycles", cycles_compared);
  for (const AmplitudeGrowth& one : all) {
    const std::optional<Estimate>& size = one.after.at(cycles_compared).critical;
    note += fmt::format("; A = {} rad: {} grains", one.amplitude, in_grains(size));
    if (size) sized.push_back(&one);
  }
  std::optional<Estimate> growth;
  std::vector<const FrameRun*> compared;
  if (sized.size() > 1) {
    const AmplitudeGrowth &low = *sized.front(), &high = *sized.back();
    growth = relative_difference(high.after.at(cycles_compared).critical,
                                 low.after.at(cycles_compared).critical);
    compared = low.runs;
    compared.insert(compared.end(), high.runs.begin(), high.runs.end());
  }
  return decide({.text = "C: the critical size grows with A",
                 .claimed = Relation::higher,
                 .id = "C.growth",
                 .cannot_be_decided = growth_cannot_be_decided},
                "critical size at the largest amplitude divided by that at the smallest, "
                "minus 1",
                growth, growth ? growth->runs : 0, note, growth_entered(compared, cycles_compared),
                Counted::runs_per_variant);
}

}  // namespace

FigureResult figure_c(const Frame& frame) {
  const std::vector<AmplitudeGrowth> all = growth_by_amplitude(frame.runs);
  FigureResult result{
      {rates_table(all), critical_table(all), largest_table(frame, all), followed_table(all)}, {}};
  for (const AmplitudeGrowth& one : all) {
    result.verdicts.push_back(critical_size_is_published(one));
  }
  if (all.size() > 1) result.verdicts.push_back(critical_size_grows(all));
  return result;
}

}  // namespace shearcell
