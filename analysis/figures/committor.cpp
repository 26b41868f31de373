// SPDX-License-Identifier: GPL-3.0-or-later
// Figure committor: the probability that a crystallite of n grains grows. Each run is a clone: it
// begins with a recorded state to which noise was added. Clones of one state have the same variant
// and the same parent stage. The supplement has no figure of this kind.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "analysis/committor.hpp"
#include "analysis/estimators.hpp"
#include "analysis/growth.hpp"
#include "analysis/styles.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// A crystallite counts as gone after this number of consecutive cycles without a descendant.
/// Verdicts use cycles_gone. The other two numbers show how much the results depend on this choice.
constexpr std::array<std::size_t, 3> cycles_without = {1, cycles_gone, 3};
constexpr std::size_t chosen_rule = 1;  ///< index of cycles_gone in cycles_without
/// If more than this fraction of the controls (see Subject) grow, a critical size is defined only
/// if the smallest crystallites grow more often than the controls. [choice]
constexpr double rare = 0.1;

/// The number of clones with each fate, in the order of Fate. The last number counts the clones
/// with Ending::revived.
struct Fates {
  Eigen::Array<std::size_t, 5, 1> clones = Eigen::Array<std::size_t, 5, 1>::Zero();

  std::size_t of(Fate fate) const { return clones[static_cast<Eigen::Index>(fate)]; }
  void add(const Ending& end) {
    ++clones[static_cast<Eigen::Index>(end.fate)];
    clones[4] += end.revived ? 1 : 0;
  }
};
void add_fates(const Fates& fates, TableRow& row) {
  row.insert(row.end(), fates.clones.begin(), fates.clones.end());
}
const std::array fate_columns = {"grown", "gone", "merged", "undecided", "revived"};

/// The outcomes for each element of cycles_without.
using FatesByRule = std::array<Fates, cycles_without.size()>;

/// A crystallite of a recorded state, or a control: a state in which all crystallites have fewer
/// than least_descendant grains.
struct Subject {
  const FrameRun* run;     ///< the first clone
  std::int32_t size;       ///< grains; 0 for a control
  FatesByRule fates = {};  ///< outcomes in all clones of the state
};

struct Amplitude : AmplitudeRuns {
  std::vector<Subject> crystallites = {}, controls = {};
  std::size_t states = 0;
  std::size_t left_out = 0;  ///< unused states: a crystallite already has grown_size grains
};

/// The crystallite maps of cycles 0, 1, 2, ... up to the first missing map.
std::vector<const CrystalliteMap*> maps_of(const FrameRun& run) {
  std::vector<const CrystalliteMap*> maps;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (checkpoint.cycle != static_cast<double>(maps.size())) continue;
    if (!checkpoint.measures.crystallite_map) break;
    maps.push_back(&*checkpoint.measures.crystallite_map);
  }
  return maps;
}

/// Adds one Subject for each followed crystallite of the state that the clones begin with, or one
/// Subject for the state if it is a control.
void add_state(RunGroup clones, Amplitude& to) {
  std::vector<std::vector<const CrystalliteMap*>> maps;  // of each clone
  for (const FrameRun* clone : clones) maps.push_back(maps_of(*clone));
  std::erase_if(maps, [](const auto& of_clone) { return of_clone.empty(); });
  if (maps.empty()) return;
  const CrystalliteMap& start = *maps.front().front();
  if (start.largest() >= grown_size) {
    ++to.left_out;
    return;
  }
  ++to.states;
  if (start.largest() < least_descendant) {
    Subject& control = to.controls.emplace_back(Subject{clones.front(), 0});
    for (const auto& of_clone : maps) {
      const bool grew = std::ranges::any_of(
          of_clone, [](const auto* map) { return map->largest() >= grown_size; });
      for (Fates& fates : control.fates) fates.add({grew ? Fate::grown : Fate::gone});
    }
  }
  for (const std::int32_t label : followed_in(start)) {
    Subject& one = to.crystallites.emplace_back(
        Subject{clones.front(), start.size[static_cast<std::size_t>(label)]});
    for (const auto& of_clone : maps) {
      const Followed found = followed(of_clone, label);
      for (std::size_t k = 0; k < cycles_without.size(); ++k) {
        one.fates[k].add(ending(found, cycles_without[k]));
      }
    }
  }
}

std::vector<Amplitude> amplitudes_of(std::span<const FrameRun> runs) {
  std::vector<Amplitude> all;
  for (const AmplitudeRuns& amplitude : by_amplitude(runs)) {
    Amplitude& one = all.emplace_back(Amplitude{amplitude});
    std::map<std::pair<std::string, std::string>, std::vector<const FrameRun*>> states;
    for (const FrameRun* run : one.runs) {
      states[{run->place.variant, run->stage.parent}].push_back(run);
    }
    for (const auto& [state, clones] : states) add_state(clones, one);
  }
  return all;
}

/// Sum of the outcomes of all subjects that have from `low` to `high` - 1 grains.
Fates sum_of(std::span<const Subject> subjects, std::size_t rule, std::int32_t low = 0,
             std::int32_t high = grown_size) {
  Fates sum;
  for (const Subject& one : subjects) {
    if (one.size >= low && one.size < high) sum.clones += one.fates[rule].clones;
  }
  return sum;
}

/// Fraction of decided clones that grew; empty if none is decided.
std::optional<double> grown_share(const Fates& fates) {
  const std::size_t decided = fates.of(Fate::grown) + fates.of(Fate::gone);
  if (decided == 0) return std::nullopt;
  return static_cast<double>(fates.of(Fate::grown)) / static_cast<double>(decided);
}

/// Of all clones of control states: the fraction in which a crystallite grew. Empty if there are no
/// control states.
std::optional<double> background(const Amplitude& one) {
  return grown_share(sum_of(one.controls, chosen_rule));
}

/// For each packing and size, the number of clones whose crystallite grew and the number whose
/// crystallite was gone. Merged clones are left out. Undecided clones are counted as grown if
/// `undecided` is Fate::grown, counted as gone if it is Fate::gone, and otherwise left out.
std::vector<GrowthBySize> by_packing_and_size(const Amplitude& one, std::size_t rule,
                                              Fate undecided = Fate::undecided) {
  std::map<std::string_view, GrowthBySize> packings;
  for (const Subject& subject : one.crystallites) {
    const Fates& fates = subject.fates[rule];
    GrowthCount& count = packings[packing_of(*subject.run)][subject.size];
    count.grew += fates.of(Fate::grown);
    count.vanished += fates.of(Fate::gone);
    if (undecided == Fate::grown) count.grew += fates.of(Fate::undecided);
    if (undecided == Fate::gone) count.vanished += fates.of(Fate::undecided);
  }
  std::vector<GrowthBySize> all;
  for (auto& [id, growth] : packings) all.push_back(std::move(growth));
  return all;
}

/// Why no critical size is defined; "" if it is defined.
std::string why_undefined(const Amplitude& one) {
  const std::optional<double> q = background(one);
  if (!q) {
    return "there is no control (a state without crystallites), so the fraction of controls that "
           "grow is unknown";
  }
  const auto smallest =
      grown_share(sum_of(one.crystallites, chosen_rule, followed_bins[0], followed_bins[1]));
  if (*q <= rare || !smallest || *smallest > *q) return "";
  return fmt::format(
      "no critical size is defined: a fraction {:.2g} of the controls form a crystallite of {} "
      "grains, but only a fraction {:.2g} of the crystallites of {} to {} grains grow",
      *q, grown_size, *smallest, followed_bins[0], followed_bins[1] - 1);
}

/// The size at which (p - q) / (1 - q) = 1/2 or, equivalently, delta_rho = 2 p - 1 = q, where p is
/// the fraction that grows and q is background(). Empty if no critical size is defined.
std::optional<Estimate> half_size(const Amplitude& one, std::size_t rule) {
  if (!why_undefined(one).empty()) return std::nullopt;
  return GrowthCurve(by_packing_and_size(one, rule), *background(one)).critical_size();
}

/// Least number of outcomes (grown or gone) that are combined in one point. [choice]
constexpr std::size_t least_drawn = 8;

Table probability_table(std::span<const Amplitude> all) {
  Table table{.name = "committor", .columns = {"amplitude_rad", "size_grains", "crystallites"}};
  table.columns.insert(table.columns.end(), fate_columns.begin(), fate_columns.end());
  table.columns.emplace_back("grown_share");
  table.chart = {
      .x = {.name = "crystallite size", .unit = "grains", .low = 0, .high = 21},
      .y = {.name = "share that grows", .low = 0, .high = 1, .clip = true},
      .lines = {{.at = 0.5, .title = "growth as probable as vanishing"}},
      .note = fmt::format("curves are smoothed over {} in ln(size)", GrowthCurve::bandwidth),
      .errors = "bars and bands are standard errors over packings"};
  for (const Amplitude& one : all) {
    std::map<std::int32_t, std::pair<std::size_t, Fates>> sizes;
    for (const Subject& subject : one.crystallites) {
      auto& [count, fates] = sizes[subject.size];
      ++count;
      fates.clones += subject.fates[chosen_rule].clones;
    }
    const std::vector<GrowthBySize> growth = by_packing_and_size(one, chosen_rule);
    const GrowthCurve curve(growth);
    Series smooth{.colour = one.look.colour, .point = 0, .join = Join::line, .band = true};
    for (const auto& [size, entry] : sizes) {
      const auto& [count, fates] = entry;
      TableRow& row = table.rows.emplace_back(TableRow{one.amplitude, std::int64_t{size}, count});
      add_fates(fates, row);
      row.push_back(grown_share(fates));
      ChartPoint& at = smooth.points.emplace_back(
          ChartPoint{static_cast<double>(size), (1 + curve.delta_rho(size)) / 2});
      if (const auto error = curve.delta_rho_error(size)) at.y_error = *error / 2;
    }
    Series data{.title = one.title, .colour = one.look.colour, .point = one.look.point};
    for (const GrowthRate& bin : growth_rates(growth, least_drawn)) {
      data.points.push_back({bin.size, (1 + bin.delta) / 2, std::nullopt, bin.delta_error / 2});
    }
    table.chart.series.insert(table.chart.series.end(), {std::move(smooth), std::move(data)});
    if (const auto q = background(one)) {
      table.chart.lines.push_back(
          {.at = *q, .colour = one.look.colour, .title = "states without crystallites"});
    }
  }
  return table;
}

Table sizes_table(std::span<const Amplitude> all) {
  Table table{.name = "committor_sizes", .columns = {"amplitude_rad", "cycles_without"}};
  add_size_columns("half_size", table.columns);
  auto& columns = table.columns;
  columns.insert(columns.end(),
                 {"not_corrected_grains", "undecided_as_grown_grains", "undecided_as_gone_grains",
                  "states", "states_left_out", "packings", "crystallites"});
  columns.insert(columns.end(), fate_columns.begin(), fate_columns.end());
  columns.insert(columns.end(), {"control_states", "control_share", "supplement_grains"});
  table.chart = {
      .x = {.name = "cycles without a descendant", .whole = true, .low = 0.5, .high = 3.5},
      .y = {.name = "crystallite size at which half grow", .unit = "grains", .low = 0, .high = 25}};
  for (const Amplitude& one : all) {
    Series sizes{.title = one.title,
                 .colour = one.look.colour,
                 .point = one.look.point,
                 .join = Join::line,
                 .shift = 0.04 * static_cast<double>(table.chart.series.size())};
    for (std::size_t rule = 0; rule < cycles_without.size(); ++rule) {
      TableRow& row = table.rows.emplace_back(TableRow{one.amplitude, cycles_without[rule]});
      const std::optional<Estimate> half = half_size(one, rule);
      add_size(half, row);
      if (half) sizes.points.push_back(point_of(static_cast<double>(cycles_without[rule]), *half));
      for (const Fate undecided : {Fate::undecided, Fate::grown, Fate::gone}) {
        const auto size = GrowthCurve(by_packing_and_size(one, rule, undecided)).critical_size();
        row.push_back(size ? TableCell(size->value) : TableCell());
      }
      row.insert(row.end(), {one.states, one.left_out, by_packing_and_size(one, rule).size(),
                             one.crystallites.size()});
      add_fates(sum_of(one.crystallites, rule), row);
      row.insert(row.end(), {one.controls.size(), background(one), one.published->critical_size});
    }
    table.chart.series.push_back(std::move(sizes));
    table.chart.lines.push_back(one.critical_line());
  }
  return table;
}

/// The data of a verdict. Each crystallite or control has one row for each value in cycles_without.
Table fates_of(std::initializer_list<const Amplitude*> amplitudes) {
  Table entered = entered_with({"size", "cycles_without"});
  entered.columns.insert(entered.columns.end(), fate_columns.begin(), fate_columns.end());
  for (const Amplitude* one : amplitudes) {
    for (const auto* subjects : {&one->crystallites, &one->controls}) {
      for (const Subject& subject : *subjects) {
        for (std::size_t rule = 0; rule < cycles_without.size(); ++rule) {
          TableRow row = {std::int64_t{subject.size}, cycles_without[rule]};
          add_fates(subject.fates[rule], row);
          enter(*subject.run, row, entered);
        }
      }
    }
  }
  return entered;
}

std::string note_on(const Amplitude& one, const std::optional<Estimate>& size) {
  const std::string why = why_undefined(one);
  return size           ? fmt::format("{:.3g} grains at A = {} rad", size->value, one.amplitude)
         : !why.empty() ? why
                        : "too few packings, or no size at which half of the crystallites grow";
}

Verdict size_is_published(const Amplitude& one) {
  std::optional<Estimate> size = half_size(one, chosen_rule);
  const std::size_t packings = by_packing_and_size(one, chosen_rule).size();
  const std::string note = fmt::format(
      "{} and {} in {}; left out: {} with an initial crystallite of {} grains or more; {}",
      counted(one.crystallites.size(), "crystallite"), counted(one.controls.size(), "control"),
      counted(packings, "packing"), counted(one.left_out, "state"), grown_size, note_on(one, size));
  const double published = one.published->critical_size;
  if (size) size = mapped(*size, [&](double grains) { return grains / published - 1; });
  if (size) size->spread /= published;
  return decide(
      {fmt::format("C: at A = {} rad half of the crystallites of {} grains grow", one.amplitude,
                   published),
       margin_critical_size, Relation::same,
       fmt::format("committor.size@amplitude_rad={}", one.amplitude)},
      fmt::format("size at which 50 % grow, relative difference from {} grains", published), size,
      packings, note, fates_of({&one}));
}

/// Decides whether the critical size grows with the amplitude, as the supplement reports. Clones at
/// different amplitudes count as independent: they have at most the packing in common.
Verdict size_grows(const Amplitude& low, const Amplitude& high) {
  const auto before = half_size(low, chosen_rule), after = half_size(high, chosen_rule);
  const std::optional<Estimate> growth = relative_difference(after, before);
  return decide({.text = fmt::format("C: the critical size is larger at A = {} rad than at {}",
                                     high.amplitude, low.amplitude),
                 .claimed = Relation::higher,
                 .id = "committor.growth"},
                "ratio of the critical sizes (at which half of the crystallites grow), minus 1",
                growth, growth ? growth->runs : 0,
                note_on(low, before) + "; " + note_on(high, after), fates_of({&low, &high}),
                Counted::runs_per_variant);
}

}  // namespace

FigureResult figure_committor(const Frame& frame) {
  const std::vector<Amplitude> all = amplitudes_of(frame.runs);
  FigureResult result{{probability_table(all), sizes_table(all)}, {}};
  for (const Amplitude& one : all) result.verdicts.push_back(size_is_published(one));
  if (all.size() > 1) result.verdicts.push_back(size_grows(all[all.size() - 2], all.back()));
  return result;
}

}  // namespace shearcell
