// SPDX-License-Identifier: GPL-3.0-or-later
// Figures nucleation and nucleation_core: the share of runs without an onset versus the cycle, and
// the rate of nucleation versus phi. The supplement has no figures of this kind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "analysis/estimators.hpp"
#include "analysis/nucleation.hpp"
#include "analysis/plots.hpp"
#include "analysis/statistics.hpp"
#include "analysis/styles.hpp"

namespace shearcell {
namespace {

using Group = std::pair<double, double>;  // amplitude, grains
using Groups = std::map<Group, std::vector<const FrameRun*>>;

Groups grouped(std::span<const FrameRun> runs) {
  Groups groups;
  for (const auto& [amplitude, members] : runs_by(runs, "amplitude_rad")) {
    for (const FrameRun* run : members) {
      groups[{amplitude, number_of(*run, "grains")}].push_back(run);
    }
  }
  return groups;
}

std::string name_of(const Group& group) {
  return fmt::format("A={} N={}", group.first, group.second);
}

/// For each group, a curve that has no points yet. If there are several amplitudes, each amplitude
/// has its own colour, which is the same in all figures. Otherwise each cell size has its own
/// colour. With Join::none, each curve has its own shift along phi, so that the points of
/// different groups in one bin of phi do not overlap.
std::map<Group, Series> series_by(const Groups& groups, Join join) {
  std::map<Group, Series> series;
  std::set<double> amplitudes;
  for (const auto& [group, runs] : groups) amplitudes.insert(group.first);
  const auto count = static_cast<double>(groups.size());
  for (const auto& [group, runs] : groups) {
    const std::size_t k = series.size();
    const bool points = join == Join::none;
    series[group] = {
        .title = formula(fmt::format("$A$ = {}, $N$ = {}", group.first, group.second)),
        .colour = amplitudes.size() > 1 ? amplitude_look(group.first, k).colour
                                        : safe_colours[k % safe_colours.size()],
        .point = points ? curve_symbol(k) : 0,
        .join = join,
        .shift = points ? phi_bin * ((static_cast<double>(k) + 0.5) / count - 0.5) * 0.8 : 0};
  }
  return series;
}

std::vector<Series> list_of(std::map<Group, Series> series) {
  std::vector<Series> all;
  for (auto& [group, one] : series) all.push_back(std::move(one));
  return all;
}

Table survival_table(const Groups& groups) {
  Table table{
      .name = "nucleation_a",
      .columns = {"group", "amplitude_rad", "grains", "cycle", "share_without_onset", "runs"}};
  std::map<Group, Series> series = series_by(groups, Join::line);
  for (const auto& [group, runs] : groups) {
    const std::vector<CensoredValue> waits = waits_for_onset(runs);
    double before = 1;
    const auto add = [&, &group = group](double cycle, double share) {
      table.rows.push_back({name_of(group), group.first, group.second, cycle, share, waits.size()});
      series[group].points.push_back({cycle, share});
    };
    add(0, before);
    for (const SurvivalStep& step : kaplan_meier(waits)) {
      add(step.cycle, before);
      add(step.cycle, step.survival);
      before = step.survival;
    }
    const auto longest = std::ranges::max_element(waits, {}, &CensoredValue::value);
    if (longest != waits.end()) add(longest->value, before);
  }
  table.chart = {.x = axis_of("cycle"),
                 .y = {.name = "share of runs without an onset", .low = 0, .high = 1},
                 .series = list_of(std::move(series))};
  return table;
}

/// Poisson error of the rate. Empty for one event: the error bar would reach zero on a log axis.
std::optional<double> error_of(const NucleationRate& bin) {
  if (bin.events < 2) return {};
  return bin.rate / std::sqrt(static_cast<double>(bin.events));
}

Table rate_table(const Groups& groups, Region region, const std::string& name) {
  Table table{.name = name,
              .columns = {"group", "amplitude_rad", "grains", "phi_low", "phi_high", "onsets",
                          "grain_cycles", "rate_per_grain_cycle", "rate_standard_error", "rate_low",
                          "rate_high"}};
  std::map<Group, Series> series = series_by(groups, Join::none);
  for (const auto& [group, runs] : groups) {
    for (const NucleationRate& bin : nucleation_rates(runs, region)) {
      table.rows.push_back({name_of(group), group.first, group.second, bin.phi_low, bin.phi_high,
                            bin.events, bin.grain_cycles,
                            bin.events > 0 ? TableCell(bin.rate) : TableCell(), error_of(bin),
                            bin.interval.low, bin.interval.high});
      if (bin.events == 0) continue;
      series[group].points.push_back(
          {.x = (bin.phi_low + bin.phi_high) / 2, .y = bin.rate, .y_error = error_of(bin)});
    }
  }
  table.chart = {.x = axis_of("phi"),
                 .y = {.name = "onsets per grain and cycle", .log = true},
                 .series = list_of(std::move(series)),
                 .note = fmt::format("points in a bin of phi ({} wide) are shifted apart", phi_bin),
                 .errors = "bars are standard errors of Poisson counts; a single onset has no bar"};
  return table;
}

/// The exponent `a` in rate ~ n^a, if the rate is proportional to the area of the walls, N^(2/3).
/// The cell has N grains, and the region has n grains. Computed from the smallest and largest
/// cells. The result is less than 2/3, because n / N grows with N. NaN unless n > 0 and n grows
/// with N.
double exponent_of_walls(std::span<const FrameRun> runs, Region region) {
  const auto sizes = runs_by(runs, "grains");
  const auto& [smallest, in_smallest] = *sizes.begin();
  const auto& [largest, in_largest] = *sizes.rbegin();
  const std::string grains = grains_of(region);
  const double few = at_start(in_smallest, grains), many = at_start(in_largest, grains);
  if (!(few > 0 && many > few)) return std::nan("");
  return 2.0 / 3 * std::log(largest / smallest) / std::log(many / few);
}

/// The verdict on the claim that the rate is proportional to the number of grains (exponent 1). The
/// margin is (1 - exponent_of_walls()) / 2. Empty unless the margin is positive and N has
/// several values.
std::vector<Verdict> rate_follows_volume(std::span<const FrameRun> runs, Region region,
                                         const std::string& id, const std::string& text) {
  if (runs_by(runs, "grains").size() < 2) return {};
  const double walls = exponent_of_walls(runs, region);
  if (!(walls < 1)) return {};
  const ClaimSpec claim{
      .id = id, .against = grains_of(region), .published = PublishedSpec{.value = 1}};
  Verdict verdict = rate_exponent.decide(claim, {.text = text, .margin = (1 - walls) / 2, .id = id},
                                         pointers(runs), {});
  if (verdict.estimate)
    verdict.note += fmt::format("; nucleation only at the walls would give {:.2f}", walls - 1);
  return {std::move(verdict)};
}

}  // namespace

FigureResult figure_nucleation(const Frame& frame) {
  const std::span<const FrameRun> runs = frame.runs;
  const Groups groups = grouped(runs);
  return {{survival_table(groups), rate_table(groups, Region::interior, "nucleation_b")},
          rate_follows_volume(runs, Region::interior, "nucleation.volume",
                              "title: the rate of nucleation is proportional to the volume, not to "
                              "the area of the walls")};
}

FigureResult figure_nucleation_core(const Frame& frame) {
  const std::span<const FrameRun> runs = frame.runs;
  return {{rate_table(grouped(runs), Region::core, "nucleation_core")},
          rate_follows_volume(runs, Region::core, "nucleation_core.volume",
                              "title: at least 4 d from the walls the rate of nucleation is "
                              "proportional to the volume")};
}

}  // namespace shearcell
