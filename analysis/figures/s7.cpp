// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S7: where crystallites near the critical size are; in two definitions of the height, and
// for several spring constants. Supplement E.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "analysis/agreement.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/nucleation_sites.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

constexpr std::size_t bins = 20;
/// Centres of such crystallites cannot lie nearer to a plane than this [d]: interior grains begin
/// 1.875 d inside a rough plane, and the crystallite has a radius. [choice]
constexpr double inaccessible = 4;
/// Fewer say nothing about a distribution over 20 bins. [choice]
constexpr std::size_t crystallites_to_tell = 200;

struct Places {
  std::vector<std::vector<double>> runs;  ///< those with any
  std::size_t count = 0;
};

Places places_of(std::span<const FigureRun* const> runs, CellAxis axis) {
  Places places;
  for (const FigureRun* run : runs) {
    std::vector<double> found = nucleus_places(*run, axis);
    if (found.empty()) continue;
    places.count += found.size();
    places.runs.push_back(std::move(found));
  }
  return places;
}

/// The smallest cell among the runs, for which the inaccessible layer is the largest share.
double smallest_width(std::span<const FigureRun> runs) {
  double width = std::numeric_limits<double>::infinity();
  for (const FigureRun& run : runs) {
    for (const CheckpointMeasures& checkpoint : run.checkpoints) {
      if (checkpoint.crystallites) width = std::min(width, checkpoint.crystallites->width);
    }
  }
  return width;
}

/// One curve of a panel.
struct Profile {
  TableValue key;  ///< in the first column
  Text title;
  Places places;
};

/// Probability density over [0, 1] of one or more distributions.
FigureTable density_table(std::string name, std::string first_column, Text x,
                          std::span<const Profile> profiles) {
  static const std::array<const char*, 4> colours = {"#000000", "#d62728", "#1f4fd8", "#2ca02c"};
  FigureTable table{.name = std::move(name),
                    .columns = {std::move(first_column), "low", "high", "probability_density",
                                "standard_error", "crystallites", "runs"},
                    .rows = {}};
  table.chart = {.x = {.symbol = std::move(x), .low = 0, .high = 1},
                 .y = {.name = "probability density", .symbol = italic("P"), .low = 0}};
  for (const Profile& profile : profiles) {
    for (const DensityBin& bin : density(profile.places.runs, bins)) {
      table.rows.push_back({profile.key, bin.low, bin.high, bin.density, table_value(bin.error),
                            static_cast<std::int64_t>(profile.places.count),
                            static_cast<std::int64_t>(profile.places.runs.size())});
    }
    const std::size_t k = table.chart.series.size();
    table.chart.series.push_back({.title = profile.title,
                                  .colour = colours[k % colours.size()],
                                  .point = 4 + 2 * static_cast<int>(k % 4),
                                  .columns = {.x = "low",
                                              .y = "probability_density",
                                              .y_error = "standard_error",
                                              .x_high = "high"},
                                  .filter = {table.columns.front(), profile.key}});
  }
  return table;
}

Text ratio(const char* length, const Text& unit) {
  return italic(length) + "/" + unit;
}

std::string enough_in_words(const Places& places) {
  return fmt::format("{} crystallites of 15 to 25 grains in {} runs", places.count,
                     places.runs.size());
}

bool enough(const Places& places) {
  return places.runs.size() >= runs_to_tell && places.count >= crystallites_to_tell;
}

Verdict uniform_in_the_middle(std::span<const DensityBin> density, const Places& places,
                              double width) {
  const double edge = (inaccessible + 1) / (width + 2);
  std::vector<DensityBin> middle;
  for (const DensityBin& bin : density) {
    if (bin.low >= edge && bin.high <= 1 - edge) middle.push_back(bin);
  }
  double mean = 0;
  for (const DensityBin& bin : middle) mean += bin.density / static_cast<double>(middle.size());
  double sum = 0;
  bool errors = !middle.empty();
  for (const DensityBin& bin : middle) {
    errors = errors && bin.error && *bin.error > 0;
    if (errors) sum += std::pow((bin.density - mean) / *bin.error, 2);
  }
  std::optional<double> rms;
  if (errors) rms = std::sqrt(sum / static_cast<double>(middle.size()));
  Verdict verdict{"E: crystallites are equally probable over the accessible central x",
                  "P(x/w) less its mean there, root mean square in standard errors",
                  rms,
                  std::nullopt,
                  Ruling::too_few_runs,
                  fmt::format("{}, {} bins", enough_in_words(places), middle.size())};
  if (!rms) return verdict;
  verdict.limit = limit_of_agreement(places.runs.size() - 1);
  if (enough(places)) verdict.ruling = *rms < *verdict.limit ? Ruling::pass : Ruling::fail;
  return verdict;
}

double upper_less_lower(const std::vector<double>& places) {
  double difference = 0;
  for (const double y : places) difference += y > 2.0 / 3 ? 1 : (y < 1.0 / 3 ? -1 : 0);
  return difference;
}

Verdict more_near_the_top(const Places& places) {
  const auto of = [&](std::span<const std::size_t> selection) {
    double difference = 0;
    double all = 0;
    for (const std::size_t run : selection) {
      difference += upper_less_lower(places.runs[run]);
      all += static_cast<double>(places.runs[run].size());
    }
    return std::optional<double>(difference / all);
  };
  std::vector<std::size_t> every;
  for (std::size_t r = 0; r < places.runs.size(); ++r) every.push_back(r);
  const std::optional<double> error = bootstrap_error(places.runs.size(), of);
  Verdict verdict{"E: crystallites are more probable near the top wall than near the bottom wall",
                  "share in the upper third less that in the lower third, in standard errors",
                  std::nullopt,
                  std::nullopt,
                  Ruling::too_few_runs,
                  enough_in_words(places)};
  if (!error || *error <= 0) return verdict;
  verdict.value = of(every).value() / *error;
  verdict.limit = limit_of_agreement(places.runs.size() - 1);
  if (!enough(places)) return verdict;
  if (*verdict.value > *verdict.limit) verdict.ruling = Ruling::pass;
  if (*verdict.value < -*verdict.limit) verdict.ruling = Ruling::fail;
  return verdict;
}

}  // namespace

FigureResult figure_s7(std::span<const FigureRun> runs) {
  // The panels of the supplement are those of the softest springs; a manifest may have others.
  const auto by_stiffness = runs_by(runs, "stiffness_N_per_m");
  std::vector<const FigureRun*> softest;
  for (const FigureRun& run : runs) {
    const double k = number_of(run, "stiffness_N_per_m");
    if (by_stiffness.empty() || k == by_stiffness.begin()->first) softest.push_back(&run);
  }
  const auto probability = [](const Text& of) { return italic("P") + "(" + of + ")"; };
  const Text x_over_w = ratio("x", italic("w")), y_over_h = ratio("y", italic("h"));
  const Text y_over_nominal = ratio("y", Text("1.675 ") + italic("L"));
  const std::array<Profile, 3> places = {
      {{"x/w", probability(x_over_w), places_of(softest, CellAxis::x)},
       {"y/h", probability(y_over_h), places_of(softest, CellAxis::y)},
       {"y/1.675L", probability(y_over_nominal), places_of(softest, CellAxis::y_nominal)}}};
  std::vector<Profile> stiffness;
  for (const auto& [k, members] : by_stiffness) {
    stiffness.push_back(
        {k, italic("k") + fmt::format(" = {} N/m", k), places_of(members, CellAxis::y)});
  }
  const std::span all(places);
  return {{density_table("S7", "axis", x_over_w + ",  " + y_over_h, all.first(2)),
           density_table("S7_heights", "axis", y_over_h + ",  " + y_over_nominal, all.last(2)),
           density_table("S7_stiffness", "stiffness_N_per_m", y_over_h, stiffness)},
          {uniform_in_the_middle(density(places[0].places.runs, bins), places[0].places,
                                 smallest_width(runs)),
           more_near_the_top(places[1].places)}};
}

}  // namespace shearcell
