// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S7: places of crystallites near the critical size, with two definitions of the height and
// for several spring constants. Supplement E.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "analysis/estimators.hpp"
#include "analysis/figure.hpp"
#include "analysis/nucleation.hpp"
#include "analysis/published.hpp"
#include "analysis/statistics.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

constexpr std::size_t density_bins = 8;
/// Smallest distance [d] from a wall to the centre of a crystallite of critical size: the smallest
/// distance of interior grains from rough walls (1.875 d) plus the crystallite's radius. [choice]
constexpr double inaccessible = 4;

struct Places {
  /// The numbers of the nuclei: one list for each packing with nuclei.
  std::vector<std::vector<double>> packings;
  std::size_t runs = 0;   ///< number of runs with nuclei
  std::size_t count = 0;  ///< number of nuclei in all packings
};

/// `number` gives the number of a nucleus, or nothing to leave it out of Places::packings. Default:
/// its place.
Places places_of(
    RunGroup runs, CellAxis axis, Seen seen = Seen::always,
    const std::function<std::optional<double>(const FrameRun&, double place)>& number =
        [](const FrameRun&, double place) { return place; }) {
  Places places;
  std::map<std::string, std::vector<double>> packings;
  for (const FrameRun* run : runs) {
    const std::vector<double> found = nucleus_places(*run, axis, seen);
    if (found.empty()) continue;
    places.count += found.size();
    ++places.runs;
    std::vector<double>& all = packings[packing_of(*run)];
    for (const double place : found) {
      if (const auto one = number(*run, place)) all.push_back(*one);
    }
  }
  for (auto& [packing, all] : packings) places.packings.push_back(std::move(all));
  return places;
}

/// Width [d] of the narrowest cell. In wider cells, `inaccessible` is a smaller part of the width.
double smallest_width(RunGroup runs) {
  double width = infinite;
  for (const FrameRun* run : runs) {
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      if (checkpoint.measures.crystallite_map)
        width = std::min(width, checkpoint.measures.crystallite_map->width);
    }
  }
  return width;
}

struct Profile {
  TableCell key;  ///< value in the first column
  Text title;
  Places places;
};

/// Probability densities of positions in [0, 1], one curve for each profile.
Table density_table(std::string name, std::string first_column, Text x,
                    std::span<const Profile> profiles) {
  static const std::array<const char*, 4> colours = {"#000000", "#d55e00", "#0072b2", "#009e73"};
  Table table{.name = std::move(name),
              .columns = {std::move(first_column), "low", "high", "probability_density",
                          "standard_error", "crystallites", "runs"}};
  table.chart = {.x = {.name = "position", .symbol = std::move(x), .low = 0, .high = 1},
                 .y = {.name = "probability density", .symbol = formula("$P$"), .low = 0},
                 .errors = "bars are standard errors over packings"};
  for (const Profile& profile : profiles) {
    const std::size_t k = table.chart.series.size();
    Series& series =
        table.chart.series.emplace_back(Series{.title = profile.title,
                                               .colour = colours[k % colours.size()],
                                               .point = 4 + 2 * static_cast<int>(k % 4)});
    for (const DensityBin& bin : density(profile.places.packings, density_bins)) {
      table.rows.push_back({profile.key, bin.low, bin.high, bin.density, bin.error,
                            profile.places.count, profile.places.runs});
      series.points.push_back(
          {.x = (bin.low + bin.high) / 2, .y = bin.density, .y_error = bin.error});
    }
  }
  return table;
}

/// Verdict on the share of nuclei in one part of the cell minus the share in another part. `side`
/// returns 1 for a nucleus in the first part, -1 in the second part, and 0 elsewhere. A nucleus for
/// which it returns nothing is left out. The bootstrap resamples packings, each with all its runs.
Verdict share_verdict(const Claim& claim, std::string quantity, RunGroup runs, CellAxis axis,
                      const std::function<std::optional<int>(double place)>& side) {
  Table entered = entered_with({"place", "value"});
  const Places nuclei = places_of(runs, axis, Seen::first, [&](const FrameRun& run, double place) {
    const std::optional<int> counted = side(place);
    if (counted) enter(run, {place, std::int64_t{*counted}}, entered);
    return counted;
  });
  const std::vector<std::vector<double>>& sides = nuclei.packings;
  std::string note = fmt::format("{} nuclei of {} to {} grains in {} of {} runs", nuclei.count,
                                 nucleus_smallest, nucleus_largest, nuclei.runs, runs.size());
  if (sides.size() < nuclei.runs) {
    note += fmt::format("; {}, and nuclei of all runs of one packing are pooled",
                        counted(sides.size(), "packing"));
  }
  if (sides.size() < least_bootstrap_runs) {
    note += fmt::format("; too few; at least {} are needed", least_bootstrap_runs);
  }
  return decide(claim, std::move(quantity), bootstrapped(sides.size(), mean_of_items(sides)),
                sides.size(), std::move(note), std::move(entered));
}

/// Compares the shares of nuclei in the inner half and the outer half of the accessible width.
Verdict uniform_in_the_middle(RunGroup runs) {
  const double half = 0.5 - (inaccessible + 1) / (smallest_width(runs) + 2);
  return share_verdict(
      {"E: crystallites are equally probable over the accessible central x", margin_share,
       Relation::same, "S7.inner"},
      "share of nuclei in the inner half of the accessible width minus that in the outer half",
      runs, CellAxis::x, [half](double x) -> std::optional<int> {
        const double away = std::abs(x - 0.5);
        if (away > half) return std::nullopt;
        return 2 * away < half ? 1 : -1;
      });
}

Verdict upper_less_lower(RunGroup runs, const Claim& claim) {
  return share_verdict(claim, "share of nuclei in the upper third minus that in the lower third",
                       runs, CellAxis::y,
                       [](double y) { return y > 2.0 / 3 ? 1 : (y < 1.0 / 3 ? -1 : 0); });
}

}  // namespace

FigureResult figure_s7(const Frame& frame) {
  const std::span<const FrameRun> runs = frame.runs;
  // If the stiffness is swept, the panels show only the softest springs, as in the supplement.
  const auto by_stiffness = runs_by(runs, "stiffness_N_per_m");
  const auto softest = by_stiffness.empty() ? pointers(runs) : by_stiffness.begin()->second;
  const auto probability = [](const std::string& of) { return formula("$P$(" + of + ")"); };
  const std::string x_over_w = "$x$/$w$", y_over_h = "$y$/$h$", y_over_nominal = "$y$/1.675 $L$";
  const std::array<Profile, 3> places = {
      {{"x/w", probability(x_over_w), places_of(softest, CellAxis::x)},
       {"y/h", probability(y_over_h), places_of(softest, CellAxis::y)},
       {"y/1.675L", probability(y_over_nominal), places_of(softest, CellAxis::y_nominal)}}};
  std::vector<Profile> stiffness;
  for (const auto& [k, members] : by_stiffness) {
    stiffness.push_back(
        {k, formula(fmt::format("$k$ = {} N/m", k)), places_of(members, CellAxis::y)});
  }
  std::vector<Verdict> verdicts = {
      uniform_in_the_middle(softest),
      upper_less_lower(softest, {fmt::format("E: crystallites are more probable near the top wall "
                                             "than near the bottom wall, by more than {} of all",
                                             margin_share),
                                 margin_share, Relation::higher, "S7.top"})};
  if (by_stiffness.size() > 1) {
    const auto& [k, members] = *by_stiffness.rbegin();
    verdicts.push_back(upper_less_lower(
        members, {fmt::format("E: at k = {} N/m crystallites are as probable near the top wall as "
                              "near the bottom wall",
                              k),
                  margin_share, Relation::same, "S7.stiff"}));
  }
  const std::span all(places);
  return {
      {density_table("S7", "axis", formula(x_over_w + ",  " + y_over_h), all.first(2)),
       density_table("S7_heights", "axis", formula(y_over_h + ",  " + y_over_nominal), all.last(2)),
       density_table("S7_stiffness", "stiffness_N_per_m", formula(y_over_h), stiffness)},
      std::move(verdicts)};
}

}  // namespace shearcell
