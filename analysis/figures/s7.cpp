// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S7: crystallites near the critical size appear all over the cell, in the middle as likely
// as anywhere, and more near the top than near the bottom. Supplement E.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/agreement.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
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

Places places_of(std::span<const FigureRun> runs, CellAxis axis) {
  Places places;
  for (const FigureRun& run : runs) {
    std::vector<double> found = nucleus_places(run, axis);
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

void add_rows(const char* axis, std::span<const DensityBin> density, const Places& places,
              FigureTable& table) {
  for (const DensityBin& bin : density) {
    table.rows.push_back({std::string(axis), bin.low, bin.high, bin.density, table_value(bin.error),
                          static_cast<std::int64_t>(places.count),
                          static_cast<std::int64_t>(places.runs.size())});
  }
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
  const Places x = places_of(runs, CellAxis::x);
  const Places y = places_of(runs, CellAxis::y);
  const std::vector<DensityBin> density_x = density(x.runs, bins);
  const std::vector<DensityBin> density_y = density(y.runs, bins);
  FigureTable table;
  table.name = "S7";
  table.columns = {"axis",           "low",          "high", "probability_density",
                   "standard_error", "crystallites", "runs"};
  add_rows("x/w", density_x, x, table);
  add_rows("y/h", density_y, y, table);
  const auto along = [](const char* axis, const char* length, const char* colour, int point) {
    return Series{.title = italic("P") + "(" + italic(axis) + "/" + italic(length) + ")",
                  .colour = colour,
                  .point = point,
                  .columns = {.x = "low",
                              .y = "probability_density",
                              .y_error = "standard_error",
                              .x_high = "high"},
                  .filter = {"axis", std::string(axis) + "/" + length}};
  };
  table.chart = {
      .x = {.symbol = italic("x") + "/" + italic("w") + ",  " + italic("y") + "/" + italic("h"),
            .low = 0,
            .high = 1},
      .y = {.name = "probability density", .symbol = italic("P"), .low = 0},
      .series = {along("x", "w", "#000000", 4), along("y", "h", "#d62728", 6)}};
  return {{std::move(table)},
          {uniform_in_the_middle(density_x, x, smallest_width(runs)), more_near_the_top(y)}};
}

}  // namespace shearcell
