// SPDX-License-Identifier: GPL-3.0-or-later
// Figure C: probability to grow less that to shrink against the size of a crystallite, for each
// amplitude. Supplement C, Fig. 4(a) of the main text.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/agreement.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/growth.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

struct AmplitudeGrowth {
  double amplitude;
  const PublishedAmplitude* published;
  std::vector<GrowthBySize> runs;  ///< those in which some crystallite could be followed
  std::vector<GrowthRate> rates;
  CriticalSize critical;
};

std::vector<AmplitudeGrowth> growth_by_amplitude(std::span<const FigureRun> runs) {
  std::vector<AmplitudeGrowth> all;
  for (const auto& [amplitude, members] : runs_by(runs, "amplitude_rad")) {
    AmplitudeGrowth one{amplitude, &published_nearest(amplitude), {}, {}, {}};
    for (const FigureRun* run : members) {
      GrowthBySize counts = growth_of(*run, one.published->n_bin);
      if (!counts.empty()) one.runs.push_back(std::move(counts));
    }
    one.rates = growth_rates(one.runs);
    one.critical = critical_size_over(one.runs);
    all.push_back(std::move(one));
  }
  return all;
}

const std::array<const char*, 5> amplitude_colours = {"#6a3d9a", "#000000", "#2ca02c", "#1f4fd8",
                                                      "#d62728"};

Chart chart_of(std::span<const AmplitudeGrowth> all, const TableRows& rows) {
  Chart chart{
      {.label = "crystallite size  [grains]", .low = 0, .high = 60},
      {.label = "{/:Italic Δρ} = {/:Italic ρ}_{g} − {/:Italic ρ}_{s}", .low = -1.05, .high = 1.05},
      {},
      {0}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    chart.series.push_back(
        {fmt::format("{{/:Italic A}} = {}", all[k].amplitude),
         amplitude_colours[k % amplitude_colours.size()], 5 + 2 * static_cast<int>(k % 5), false,
         chart_points(rows, {.x = 2, .x_error = 0, .y = 6, .y_error = 7}, 1, all[k].amplitude)});
  }
  return chart;
}

std::string plot(std::span<const AmplitudeGrowth> all) {
  std::string text =
      "set xlabel 'crystallite size  [grains]'\n"
      "set ylabel '{/:Italic Δρ} = {/:Italic ρ}_{g} − {/:Italic ρ}_{s}'\n"
      "set xrange [0:60]\nset yrange [-1.05:1.05]\nset offsets 0,0,0,0\n"
      "set arrow from graph 0, first 0 to graph 1, first 0 nohead dt 2 lc rgb '#888888'\n";
  for (std::size_t k = 0; k < all.size(); ++k) {
    text += fmt::format("set arrow from {0}, graph 0 to {0}, graph 0.06 nohead lw 2 lc rgb '{1}'\n",
                        all[k].published->critical_size,
                        amplitude_colours[k % amplitude_colours.size()]);
  }
  const bool any = std::any_of(all.begin(), all.end(),
                               [](const AmplitudeGrowth& one) { return !one.rates.empty(); });
  if (!any) return text;
  for (std::size_t k = 0; k < all.size(); ++k) {
    text += fmt::format(
        "{}{}", k == 0 ? "plot " : ", \
     ",
        points_with_errors(
            "2", fmt::format("(column(1) == {} ? column(6) : NaN)", all[k].amplitude), 7,
            amplitude_colours[k % amplitude_colours.size()], 5 + 2 * static_cast<int>(k % 5),
            fmt::format("{{/:Italic A}} = {}", all[k].amplitude)));
  }
  return text + "\n";
}

FigureTable rates_table(std::span<const AmplitudeGrowth> all) {
  FigureTable table;
  table.name = std::string("C");  // not assigned: GCC 12 warns of an overlap that is none
  table.columns = {"amplitude_rad",      "size_grains",    "grow_probability",
                   "shrink_probability", "binomial_error", "delta_rho",
                   "delta_rho_error",    "crystallites",   "runs"};
  for (const AmplitudeGrowth& one : all) {
    for (const GrowthRate& rate : one.rates) {
      table.rows.push_back({one.amplitude, std::int64_t{rate.size}, rate.grow, rate.shrink,
                            rate.grow_error, rate.delta, rate.delta_error,
                            static_cast<std::int64_t>(rate.counted),
                            static_cast<std::int64_t>(one.runs.size())});
    }
  }
  table.plot = plot(all);
  table.chart = chart_of(all, table.rows);
  return table;
}

FigureTable critical_table(std::span<const AmplitudeGrowth> all) {
  FigureTable table;
  table.name = "C_critical_size";
  table.columns = {"amplitude_rad",        "cycles_followed",
                   "critical_size_grains", "critical_size_standard_error_grains",
                   "supplement_grains",    "runs"};
  bool any = false;
  for (const AmplitudeGrowth& one : all) {
    table.rows.push_back({one.amplitude, one.published->n_bin, table_value(one.critical.size),
                          table_value(one.critical.error), one.published->critical_size,
                          static_cast<std::int64_t>(one.runs.size())});
    any = any || one.critical.size.has_value();
  }
  table.chart = {{.label = "amplitude  {/:Italic A}  [rad]", .low = 0, .high = 0.12},
                 {.label = "critical size  [grains]", .low = 0},
                 {{"supplement", "#888888", 6, true,
                   chart_points(table.rows, {.x = 1, .x_error = 0, .y = 5, .y_error = 0})},
                  {"simulated", "#000000", 5, false,
                   chart_points(table.rows, {.x = 1, .x_error = 0, .y = 3, .y_error = 4})}},
                 {}};
  table.plot =
      "set xlabel 'amplitude  {/:Italic A}  [rad]'\n"
      "set ylabel 'critical size  [grains]'\nset xrange [0:0.12]\nset yrange [0:*]\n";
  if (all.empty()) return table;
  table.plot +=
      "plot data using 1:5 with linespoints lc rgb '#888888' dt 2 pt 6 title 'supplement'";
  if (any) {
    table.plot += ", \\\n     " + points_with_errors("1", "3", 4, "#000000", 5, "simulated");
  }
  table.plot += "\n";
  return table;
}

/// Crystallites of about the critical size that could be followed, and the runs that had any.
struct NearCritical {
  std::size_t crystallites = 0;
  std::size_t runs = 0;
};
NearCritical near_critical(const AmplitudeGrowth& one) {
  NearCritical near;
  for (const GrowthBySize& run : one.runs) {
    std::size_t counted = 0;
    for (const auto& [size, count] : run) {
      const double ratio = size / one.published->critical_size;
      if (ratio > 0.5 && ratio < 1.5) counted += count.grew + count.shrank;
    }
    near.crystallites += counted;
    near.runs += counted > 0 ? 1 : 0;
  }
  return near;
}

/// The supplement states whole numbers and says "about": one grain is allowed for that. A limit of
/// more than half of the stated size would let anything pass, and so tells nothing.
Verdict critical_size_is_published(const AmplitudeGrowth& one) {
  std::optional<double> distance;
  double limit = 1;
  const NearCritical near = near_critical(one);
  std::string note =
      fmt::format("{} crystallites of about that size followed over {} cycles in {} runs",
                  near.crystallites, one.published->n_bin, near.runs);
  if (one.critical.size) {
    distance = std::abs(*one.critical.size - one.published->critical_size);
    note += fmt::format("; {:.1f} grains", *one.critical.size);
  }
  if (one.critical.error) {
    limit += limit_of_agreement(one.runs.size() - 1) * *one.critical.error;
    note += fmt::format(" +- {:.1f}", *one.critical.error);
  }
  constexpr std::size_t crystallites_to_tell = 50;
  const bool enough = near.runs >= runs_to_tell && near.crystallites >= crystallites_to_tell &&
                      one.critical.error.has_value() && limit <= one.published->critical_size / 2;
  return below_if(enough,
                  fmt::format("C: the critical size at A = {} rad is about {} grains",
                              one.amplitude, one.published->critical_size),
                  "distance from that [grains]", distance, limit, note);
}

}  // namespace

FigureResult figure_c(std::span<const FigureRun> runs) {
  const std::vector<AmplitudeGrowth> all = growth_by_amplitude(runs);
  FigureResult result{{rates_table(all), critical_table(all)}, {}};
  for (const AmplitudeGrowth& one : all) {
    result.verdicts.push_back(critical_size_is_published(one));
  }
  return result;
}

}  // namespace shearcell
