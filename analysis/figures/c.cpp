// SPDX-License-Identifier: GPL-3.0-or-later
// Figure C: growth of crystallites. Probability to grow minus probability to shrink against size,
// critical size against amplitude, and largest crystallite against phi. Supplement C, Figs. 4(a)
// and 4(b) of the main text.
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

Text title_of(double amplitude) {
  return italic("A") + fmt::format(" = {}", amplitude);
}

const char* colour_of(std::size_t k) {
  return amplitude_colours[k % amplitude_colours.size()];
}

int point_of(std::size_t k) {
  return 5 + 2 * static_cast<int>(k % 5);
}

Chart chart_of(std::span<const AmplitudeGrowth> all) {
  Chart chart{
      .x = {.name = "crystallite size", .unit = "grains", .low = 0, .high = 60, .clip = true},
      .y = {.symbol = italic("Δρ") + " = " + italic("ρ") + subscript("g") + " − " + italic("ρ") +
                      subscript("s"),
            .low = -1.05,
            .high = 1.05,
            .clip = true},
      .lines = {{0}}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    chart.series.push_back(
        {.title = title_of(all[k].amplitude),
         .colour = colour_of(k),
         .point = point_of(k),
         .columns = {.x = "size_grains", .y = "delta_rho", .y_error = "delta_rho_error"},
         .filter = {"amplitude_rad", all[k].amplitude}});
    chart.lines.push_back({all[k].published->critical_size, true, true, colour_of(k)});
  }
  return chart;
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
  table.chart = chart_of(all);
  return table;
}

FigureTable critical_table(std::span<const AmplitudeGrowth> all) {
  FigureTable table;
  table.name = "C_critical_size";
  table.columns = {"amplitude_rad",        "cycles_followed",
                   "critical_size_grains", "critical_size_standard_error_grains",
                   "supplement_grains",    "runs"};
  for (const AmplitudeGrowth& one : all) {
    table.rows.push_back({one.amplitude, one.published->n_bin, table_value(one.critical.size),
                          table_value(one.critical.error), one.published->critical_size,
                          static_cast<std::int64_t>(one.runs.size())});
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
                                         .y_error = "critical_size_standard_error_grains"}}}};
  return table;
}

/// Fig. 4(b) of the main text: with method 1 of section C the onset is the phi at which a curve
/// reaches its critical size. No crystallite counts as one grain, as in method 2.
FigureTable largest_table(std::span<const FigureRun> runs, std::span<const AmplitudeGrowth> all) {
  std::vector<CurveStyle> styles;
  std::vector<ReferenceLine> lines;
  for (std::size_t k = 0; k < all.size(); ++k) {
    styles.push_back({all[k].amplitude, title_of(all[k].amplitude), colour_of(k), point_of(k)});
    lines.push_back({.at = all[k].published->critical_size, .colour = colour_of(k)});
  }
  const MeasureColumn largest{"largest_crystallite", "grains", [](const Measures& m) {
                                return std::max(1.0, static_cast<double>(m.largest_crystallite));
                              }};
  FigureTable table = against_phi("C_largest", curves_of(runs, "amplitude_rad", styles), largest,
                                  {.name = "largest crystallite", .unit = "grains", .log = true});
  table.chart.lines = std::move(lines);
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
  FigureResult result{{rates_table(all), critical_table(all), largest_table(runs, all)}, {}};
  for (const AmplitudeGrowth& one : all) {
    result.verdicts.push_back(critical_size_is_published(one));
  }
  return result;
}

}  // namespace shearcell
