// SPDX-License-Identifier: GPL-3.0-or-later
// Figure committor: the probability that a crystallite of n grains grows, from clones of states. A
// run is a clone: it begins with a recorded state, cycle 0, with noise of its own. The clones of
// one state have the same variant. Not in the supplement.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "analysis/committor.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/growth.hpp"
#include "analysis/published.hpp"
#include "analysis/statistics.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// Cycles without a descendant after which a crystallite is gone, and others, which show how the
/// result depends on that. [choice]
constexpr std::size_t cycles_gone = 2;
constexpr std::array<std::size_t, 3> cycles_without = {1, 2, 3};
/// Of controls that grow. No critical size is defined where more of them grow, unless the smallest
/// crystallites grow more often than they do. [choice]
constexpr double rare = 0.1;

/// Fates of a crystallite in the clones of its state.
struct Fates {
  std::array<std::size_t, 4> clones = {};  ///< by Fate
  std::size_t revived = 0;                 ///< of those that were gone

  std::size_t of(Fate fate) const { return clones[static_cast<std::size_t>(fate)]; }
  void add(const Fates& other) {
    for (std::size_t k = 0; k < clones.size(); ++k) clones[k] += other.clones[k];
    revived += other.revived;
  }
};

/// The fates for each of cycles_without.
using FatesByRule = std::array<Fates, cycles_without.size()>;

/// The states that begin with one packing.
struct Packing {
  std::map<std::int32_t, FatesByRule> fates;  ///< by size at the start
  std::size_t control_clones = 0, controls_grown = 0;
};

struct Amplitude {
  double amplitude = 0;
  CurveStyle style;
  std::map<std::string, Packing> packings = {};
  std::size_t states = 0, crystallites = 0, controls = 0;
  std::size_t left_out = 0;  ///< states that have a crystallite of `grown_size` grains already
  std::vector<std::pair<const FigureRun*, TableRow>> entered = {};

  std::vector<const Packing*> units() const {
    std::vector<const Packing*> all;
    for (const auto& [id, packing] : packings) all.push_back(&packing);
    return all;
  }
};

using Units = std::span<const Packing* const>;

/// The maps of whole cycles from 0 on, up to the first that is missing.
std::vector<const CrystalliteMap*> maps_of(const FigureRun& run) {
  std::vector<const CrystalliteMap*> maps;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (checkpoint.cycle != static_cast<double>(maps.size())) continue;
    if (!checkpoint.measures.crystallite_map) break;
    maps.push_back(&*checkpoint.measures.crystallite_map);
  }
  return maps;
}

std::int32_t largest_in(const CrystalliteMap& map) {
  return map.size.empty() ? 0 : std::ranges::max(map.size);
}

void add_control(RunGroup clones, Packing& packing) {
  for (const FigureRun* clone : clones) {
    const auto maps = maps_of(*clone);
    ++packing.control_clones;
    if (std::ranges::any_of(maps, [](auto* map) { return largest_in(*map) >= grown_size; })) {
      ++packing.controls_grown;
    }
  }
}

/// Adds the clones of one state.
void add_state(RunGroup clones, Amplitude& to) {
  const FigureRun& first = *clones.front();
  const std::vector<const CrystalliteMap*> starts = maps_of(first);
  if (starts.empty()) return;
  const std::int32_t largest = largest_in(*starts.front());
  if (largest >= grown_size) {
    ++to.left_out;
    return;
  }
  Packing& packing = to.packings[packing_of(first)];
  ++to.states;
  if (largest < least_descendant) {
    ++to.controls;
    const std::size_t grown = packing.controls_grown;
    add_control(clones, packing);
    to.entered.emplace_back(&first, TableRow{std::int64_t{0},
                                             std::int64_t{0},
                                             packing.controls_grown - grown,
                                             clones.size() - (packing.controls_grown - grown),
                                             {},
                                             {},
                                             {}});
  }
  for (const std::int32_t label : followed_in(*starts.front())) {
    ++to.crystallites;
    FatesByRule fates;
    for (const FigureRun* clone : clones) {
      const auto maps = maps_of(*clone);
      if (maps.empty()) continue;
      const Followed one = followed(maps, label);
      for (std::size_t k = 0; k < fates.size(); ++k) {
        const Ending end = ending(one, cycles_without[k]);
        ++fates[k].clones[static_cast<std::size_t>(end.fate)];
        fates[k].revived += end.revived ? 1 : 0;
      }
    }
    const std::int32_t size = starts.front()->size[static_cast<std::size_t>(label)];
    for (std::size_t k = 0; k < fates.size(); ++k) {
      packing.fates[size][k].add(fates[k]);
      to.entered.emplace_back(
          &first, TableRow{std::int64_t{size}, cycles_without[k], fates[k].of(Fate::grown),
                           fates[k].of(Fate::gone), fates[k].of(Fate::merged),
                           fates[k].of(Fate::undecided), fates[k].revived});
    }
  }
}

std::vector<Amplitude> amplitudes_of(std::span<const FigureRun> runs) {
  std::vector<Amplitude> all;
  for (const auto& [amplitude, members] : runs_by(runs, "amplitude_rad")) {
    const std::size_t k = all.size();
    Amplitude& one =
        all.emplace_back(Amplitude{.amplitude = amplitude,
                                   .style = {.where = {},
                                             .title = italic("A") + fmt::format(" = {}", amplitude),
                                             .colour = safe_colours[k % safe_colours.size()],
                                             .point = curve_symbol(k)}});
    std::map<std::string, std::vector<const FigureRun*>> states;
    for (const FigureRun* run : members) states[run->variant].push_back(run);
    for (const auto& [variant, clones] : states) add_state(clones, one);
  }
  return all;
}

std::size_t rule_of(std::size_t cycles) {
  return static_cast<std::size_t>(std::ranges::find(cycles_without, cycles) -
                                  cycles_without.begin());
}

/// How a clone that ends before the fate is decided counts.
enum class Undecided { left_out, grown, gone };

/// Clones that grew and that were gone, by size, of each packing. Merged ones are left out.
std::vector<GrowthBySize> growth_by_packing(Units packings, std::size_t rule, Undecided undecided) {
  std::vector<GrowthBySize> all;
  for (const Packing* packing : packings) {
    GrowthBySize& growth = all.emplace_back();
    for (const auto& [size, fates] : packing->fates) {
      const Fates& one = fates[rule];
      GrowthCount& count = growth[size];
      count.grew = one.of(Fate::grown);
      count.shrank = one.of(Fate::gone);
      if (undecided == Undecided::grown) count.grew += one.of(Fate::undecided);
      if (undecided == Undecided::gone) count.shrank += one.of(Fate::undecided);
    }
  }
  return all;
}

/// Share of control clones that grew; none without controls.
std::optional<double> background(Units packings) {
  std::size_t clones = 0, grown = 0;
  for (const Packing* packing : packings) {
    clones += packing->control_clones;
    grown += packing->controls_grown;
  }
  if (clones == 0) return std::nullopt;
  return static_cast<double>(grown) / static_cast<double>(clones);
}

/// The size at which p = 1/2, with p of the curve that is fitted, or with (p - q) / (1 - q), q the
/// background.
std::optional<double> half_size(Units packings, std::size_t rule, bool corrected,
                                Undecided undecided = Undecided::left_out) {
  const std::optional<double> q = corrected ? background(packings) : 0;
  const std::optional<GrowthFit> fit = fit_growth(growth_by_packing(packings, rule, undecided));
  if (!q || !fit || !(fit->slope > 0)) return std::nullopt;
  return std::exp((std::log((1 + *q) / (1 - *q)) - fit->intercept) / fit->slope);
}

/// Share that grew of the clones that are decided, of sizes low to high - 1.
std::optional<double> grown_share(Units packings, std::int32_t low, std::int32_t high) {
  double grown = 0, decided = 0;
  for (const GrowthBySize& growth :
       growth_by_packing(packings, rule_of(cycles_gone), Undecided::left_out)) {
    for (const auto& [size, count] : growth) {
      if (size < low || size >= high) continue;
      grown += static_cast<double>(count.grew);
      decided += static_cast<double>(count.grew + count.shrank);
    }
  }
  if (decided == 0) return std::nullopt;
  return grown / decided;
}

/// The bootstrap draws packings with all their states.
template <class Statistic>
std::optional<Estimate> over(const std::vector<const Packing*>& packings,
                             const Statistic& statistic) {
  return bootstrapped(packings.size(), [&](std::span<const std::size_t> selection) {
    std::vector<const Packing*> selected;
    for (const std::size_t k : selection) selected.push_back(packings[k]);
    return std::optional<double>(statistic(Units(selected)));
  });
}

std::optional<Estimate> half_size_of(const Amplitude& one, std::size_t rule, bool corrected) {
  auto found =
      over(one.units(), [&](Units packings) { return half_size(packings, rule, corrected); });
  if (found && (found->value < 1 || found->value > grown_size)) found.reset();
  return found;
}

/// The share of the smallest crystallites that grow less that of the controls.
std::optional<Estimate> smallest_less_controls(const Amplitude& one) {
  return over(one.units(), [](Units packings) -> std::optional<double> {
    const auto share = grown_share(packings, followed_bins[0], followed_bins[1]);
    const auto q = background(packings);
    if (!share || !q) return std::nullopt;
    return *share - *q;
  });
}

/// Why no critical size is defined; "" if one is.
std::string why_undefined(const Amplitude& one) {
  const std::vector<const Packing*> packings = one.units();
  const std::optional<double> q = background(packings);
  if (!q) return "the background is not known: no state is without crystallites";
  if (*q <= rare) return "";
  const std::optional<Estimate> more = smallest_less_controls(one);
  if (more && more->interval.low > 0) return "";
  const auto share = grown_share(packings, followed_bins[0], followed_bins[1]);
  return fmt::format(
      "no critical size is defined: {:.2g} of the states without crystallites have one of {} "
      "grains in time, and {} of the crystallites of {} and {} grains grow",
      *q, grown_size, share ? fmt::format("{:.2g}", *share) : "none", followed_bins[0],
      followed_bins[1] - 1);
}

/// The curve, with half the length of its interval as its error.
std::vector<ChartPoint> fitted_points(const Amplitude& one) {
  const std::size_t rule = rule_of(cycles_gone);
  const auto growth = growth_by_packing(one.units(), rule, Undecided::left_out);
  const std::optional<GrowthFit> fit = fit_growth(growth);
  if (!fit) return {};
  std::vector<double> sizes(18);
  std::iota(sizes.begin(), sizes.end(), double{least_descendant});
  const auto estimates = fitted_delta_rho(growth, sizes);
  std::vector<ChartPoint> points;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    ChartPoint& at = points.emplace_back(ChartPoint{sizes[k], (1 + fit->delta_rho(sizes[k])) / 2});
    if (const auto& found = estimates[k])
      at.y_error = (found->interval.high - found->interval.low) / 4;
  }
  return points;
}

FigureTable probability_table(std::span<const Amplitude> all) {
  FigureTable table{
      .name = "committor",
      .columns = {"amplitude_rad", "size_low_grains", "size_high_grains", "grown_share",
                  "standard_error", "grown", "gone", "merged", "undecided", "revived"}};
  table.chart = {.x = {.name = "crystallite size", .unit = "grains", .low = 0, .high = 22},
                 .y = {.name = "share that grows", .low = 0, .high = 1},
                 .lines = {{.at = 0.5, .title = "growth as probable as vanishing"}},
                 .errors =
                     "bars are standard errors over packings, bands half the length of the "
                     "90 % interval of the fit"};
  for (const Amplitude& one : all) {
    const std::vector<const Packing*> packings = one.units();
    for (std::size_t bin = 0; bin + 1 < std::size(followed_bins); ++bin) {
      const std::int32_t low = followed_bins[bin], high = followed_bins[bin + 1];
      Fates sum;
      for (const Packing* packing : packings) {
        for (const auto& [size, fates] : packing->fates) {
          if (size >= low && size < high) sum.add(fates[rule_of(cycles_gone)]);
        }
      }
      const auto error = bootstrap_error(packings.size(), [&](auto selection) {
        std::vector<const Packing*> selected;
        for (const std::size_t k : selection) selected.push_back(packings[k]);
        return grown_share(selected, low, high);
      });
      table.rows.push_back({one.amplitude, std::int64_t{low}, std::int64_t{high - 1},
                            grown_share(packings, low, high), error, sum.of(Fate::grown),
                            sum.of(Fate::gone), sum.of(Fate::merged), sum.of(Fate::undecided),
                            sum.revived});
    }
    table.chart.series.push_back({.colour = one.style.colour,
                                  .point = 0,
                                  .join = Join::line,
                                  .band = true,
                                  .points = fitted_points(one)});
    table.chart.series.push_back({.title = one.style.title,
                                  .colour = one.style.colour,
                                  .point = one.style.point,
                                  .columns = {.x = "size_low_grains",
                                              .y = "grown_share",
                                              .y_error = "standard_error",
                                              .x_high = "size_high_grains"},
                                  .filter = {"amplitude_rad", one.amplitude}});
    if (const auto q = background(packings)) {
      table.chart.lines.push_back(
          {.at = *q, .colour = one.style.colour, .title = "states without crystallites"});
    }
  }
  return table;
}

void add_interval(const std::optional<Estimate>& size, TableRow& row) {
  if (!size) return row.resize(row.size() + 3);
  row.insert(row.end(), {size->value, size->interval.low, size->interval.high});
}

FigureTable sizes_table(std::span<const Amplitude> all) {
  FigureTable table{.name = "committor_sizes",
                    .columns = {"amplitude_rad",
                                "cycles_without",
                                "half_size_grains",
                                "half_size_low_grains",
                                "half_size_high_grains",
                                "half_size_error_grains",
                                "not_corrected_grains",
                                "not_corrected_low_grains",
                                "not_corrected_high_grains",
                                "undecided_as_grown_grains",
                                "undecided_as_gone_grains",
                                "states",
                                "left_out",
                                "packings",
                                "crystallites",
                                "grown",
                                "gone",
                                "merged",
                                "undecided",
                                "revived_share_of_gone",
                                "control_states",
                                "control_clones",
                                "control_share",
                                "supplement_grains"}};
  table.chart = {
      .x = {.name = "cycles without a descendant", .whole = true, .low = 0.5, .high = 3.5},
      .y = {.name = "size that grows as often as not", .unit = "grains", .low = 0},
      .errors = "bars are half the length of the 90 % interval"};
  for (const Amplitude& one : all) {
    const std::vector<const Packing*> packings = one.units();
    const double published = published_nearest(one.amplitude).critical_size;
    std::size_t control_clones = 0;
    for (const Packing* packing : packings) control_clones += packing->control_clones;
    for (std::size_t rule = 0; rule < cycles_without.size(); ++rule) {
      Fates sum;
      for (const Packing* packing : packings) {
        for (const auto& [size, fates] : packing->fates) sum.add(fates[rule]);
      }
      const std::size_t gone = sum.of(Fate::gone);
      const auto size = half_size_of(one, rule, true);
      TableRow& row = table.rows.emplace_back(TableRow{one.amplitude, cycles_without[rule]});
      add_interval(size, row);
      row.push_back(size ? TableValue((size->interval.high - size->interval.low) / 2)
                         : TableValue());
      add_interval(half_size_of(one, rule, false), row);
      row.insert(row.end(), {half_size(packings, rule, false, Undecided::grown),
                             half_size(packings, rule, false, Undecided::gone), one.states,
                             one.left_out, packings.size(), one.crystallites, sum.of(Fate::grown),
                             gone, sum.of(Fate::merged), sum.of(Fate::undecided),
                             gone > 0 ? TableValue(static_cast<double>(sum.revived) /
                                                   static_cast<double>(gone))
                                      : TableValue(),
                             one.controls, control_clones, background(packings), published});
    }
    table.chart.series.push_back({.title = one.style.title,
                                  .colour = one.style.colour,
                                  .point = one.style.point,
                                  .join = Join::line,
                                  .columns = {.x = "cycles_without",
                                              .y = "half_size_grains",
                                              .y_error = "half_size_error_grains"},
                                  .filter = {"amplitude_rad", one.amplitude},
                                  .shift = 0.04 * static_cast<double>(table.chart.series.size())});
    table.chart.lines.push_back(
        {.at = published, .colour = one.style.colour, .title = "the supplement's critical sizes"});
  }
  return table;
}

/// What enters a verdict: one row for each crystallite and rule, one of size 0 for each control.
Entered entered_fates(const Amplitude& one) {
  Entered entered =
      entered_with({"size", "cycles_without", "grown", "gone", "merged", "undecided", "revived"});
  for (const auto& [run, values] : one.entered) enter(*run, values, entered);
  return entered;
}

Verdict size_is_published(const Amplitude& one) {
  const double published = published_nearest(one.amplitude).critical_size;
  const std::size_t rule = rule_of(cycles_gone);
  std::optional<Estimate> relative = half_size_of(one, rule, true);
  std::string note = fmt::format(
      "{} in {} of {}; {} left out, which had {} grains at the start",
      counted(one.crystallites, "crystallite"), counted(one.states, "state"),
      counted(one.packings.size(), "packing"), counted(one.left_out, "state"), grown_size);
  if (const std::string why = why_undefined(one); !why.empty()) {
    note += "; " + why;
    relative.reset();
  } else if (relative) {
    note += fmt::format("; {:.3g} grains", relative->value);
    relative = mapped(*relative, [&](double size) { return size / published - 1; });
    relative->spread /= published;
  } else {
    note += "; too few packings, or no size grows as often as not";
  }
  Verdict verdict =
      decide({fmt::format("C: at A = {} rad a crystallite of {} grains grows as often as not",
                          one.amplitude, published),
              margin_critical_size},
             fmt::format("critical size, relative difference from {} grains", published), relative,
             one.packings.size(), note);
  verdict.entered = entered_fates(one);
  return verdict;
}

/// The claim that the size at the larger amplitude is the larger one. The bootstrap draws the
/// packings of both amplitudes, which may share them.
Verdict size_rises(const Amplitude& low, const Amplitude& high) {
  std::vector<std::string> ids;
  for (const Amplitude* one : {&low, &high}) {
    for (const auto& [id, packing] : one->packings) ids.push_back(id);
  }
  std::ranges::sort(ids);
  const auto repeated = std::ranges::unique(ids);
  ids.erase(repeated.begin(), repeated.end());
  const auto size_at = [&](const Amplitude& one, std::span<const std::size_t> selection) {
    std::vector<const Packing*> packings;
    for (const std::size_t k : selection) {
      const auto found = one.packings.find(ids[k]);
      if (found != one.packings.end()) packings.push_back(&found->second);
    }
    return half_size(packings, rule_of(cycles_gone), true);
  };
  std::string why = why_undefined(low);
  if (why.empty()) why = why_undefined(high);
  std::optional<Estimate> change;
  if (why.empty()) {
    change = bootstrapped(ids.size(), [&](auto selection) -> std::optional<double> {
      const auto before = size_at(low, selection), after = size_at(high, selection);
      if (!before || !after) return std::nullopt;
      return *after / *before - 1;
    });
    if (!change) why = "too few packings, or no size grows as often as not";
  }
  Verdict verdict =
      decide({fmt::format("C: the critical size is larger at A = {} rad than at {}", high.amplitude,
                          low.amplitude),
              0, Claimed::above},
             "relative difference of the sizes that grow as often as not", change, ids.size(), why);
  verdict.entered = entered_fates(high);
  std::ranges::copy(entered_fates(low).rows, std::back_inserter(verdict.entered.rows));
  return verdict;
}

}  // namespace

FigureResult figure_committor(std::span<const FigureRun> runs) {
  const std::vector<Amplitude> all = amplitudes_of(runs);
  FigureResult result{{probability_table(all), sizes_table(all)}, {}};
  for (const Amplitude& one : all) result.verdicts.push_back(size_is_published(one));
  if (all.size() > 1) result.verdicts.push_back(size_rises(all[all.size() - 2], all.back()));
  return result;
}

}  // namespace shearcell
