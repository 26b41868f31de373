// SPDX-License-Identifier: GPL-3.0-or-later
// Figures S5a, S5b and S6: volume fraction at the onset of crystallization against amplitude, by
// both methods, against the size of the system, and with and without gravity. Supplement C and D.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "analysis/claims.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/onset.hpp"
#include "analysis/published.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// The claim that the onset by method 1 is at phi = 0.646.
Verdict onset_is_published(RunGroup runs, std::string claim) {
  return compare_with({std::move(claim), margin_onset_phi}, onset_phi(), runs, published_onset_phi);
}

/// The supplement's N_inves for N = `grains`; none if the supplement has no such N.
std::optional<double> published_interior(double grains) {
  const auto size = std::ranges::find(published_sizes, grains, &PublishedSize::grains);
  if (size == published_sizes.end()) return std::nullopt;
  return size->interior_grains;
}

/// The claim that runs of `grains` grains, a size of the supplement, have the supplement's N_inves.
Verdict interior_is_published(double grains, RunGroup runs) {
  const double published = published_interior(grains).value();
  Scalar interior = over_cycles("N_inves", "interior_grains", 0, 0);
  interior.relative = true;
  return compare_with(
      {fmt::format("C: N = {} has {} grains at least 1.5 d from the walls", grains, published),
       margin_interior},
      interior, runs, published);
}

/// `columns`, then those of an onset.
std::vector<std::string> onset_columns(std::vector<std::string> columns) {
  add_columns(onset_column, columns);
  columns.insert(columns.end(), {"runs", "runs_ended_before", "runs_began_after", "runs_unclear"});
  return columns;
}

/// `row`, then the values of those columns.
TableRow onset_row(TableRow row, const Onset& onset) {
  row.insert(row.end(), {onset.phi.mean, onset.phi_error, onset.phi.runs, onset.never,
                         onset.before_start, onset.unclear});
  return row;
}

/// Points of those columns against the column `x`.
Series onset_points(Text title, const char* colour, int point, const char* x,
                    RowFilter filter = {}) {
  return {.title = std::move(title),
          .colour = colour,
          .point = point,
          .columns = columns_against(x, onset_column),
          .filter = std::move(filter)};
}

using Amplitudes = std::map<double, std::vector<const FigureRun*>>;

/// The supplement takes the standard deviation of its simulations at A = 0.05 rad as the error of
/// the one experiment. This is that of our runs, by method 1.
std::optional<double> experiment_error(const Amplitudes& amplitudes) {
  for (const auto& [amplitude, members] : amplitudes) {
    if (std::abs(amplitude - 0.05) >= 1e-6) continue;
    const RunStatistics phi = onset(members, onset_by_size).phi;
    if (phi.standard_error) return *phi.standard_error * std::sqrt(static_cast<double>(phi.runs));
  }
  return std::nullopt;
}

FigureTable amplitude_table(const Amplitudes& amplitudes) {
  FigureTable table{.name = "S5a",
                    .columns = onset_columns({"method", "amplitude_rad", "critical_size_grains"})};
  for (const int method : {1, 2}) {
    for (const auto& [amplitude, members] : amplitudes) {
      table.rows.push_back(
          onset_row({method, amplitude, published_nearest(amplitude).critical_size},
                    onset(members, method == 1 ? onset_by_size : onset_by_slope)));
    }
  }
  Series by_size =
      onset_points("largest crystallite is critical", "#0072b2", 9, "amplitude_rad", {"method", 1});
  Series by_slope = onset_points("steepest growth", "#009e73", 13, "amplitude_rad", {"method", 2});
  by_slope.shift = 0.001;
  table.chart = {.x = amplitude_axis,
                 .y = onset_axis,
                 .series = {{.title = "experiment",
                             .colour = "#e69f00",
                             .points = {{experiment_amplitude_rad,
                                         experiment_onset_phi,
                                         {},
                                         experiment_error(amplitudes)}}},
                            std::move(by_size),
                            std::move(by_slope)},
                 .lines = onset_lines(),
                 .errors =
                     "bars are standard errors over runs, that of the experiment the "
                     "standard deviation of the runs at A = 0.05 rad"};
  return table;
}

/// The difference of both methods in each run.
Verdict methods_agree(double amplitude, RunGroup runs) {
  Scalar shift = of_whole_run(*find_measure("onset_slope_phi", MeasureKind::run));
  shift.name = "phi at the onset by steepest growth less that by size";
  shift.of = [by_slope = shift.of, by_size = onset_phi().of](const FigureRun& run) {
    RunValue value = by_slope(run);
    const RunValue other = by_size(run);
    if (other.missing != Missing::nothing) return other;
    value.value -= other.value;
    return value;
  };
  return compare_with({fmt::format("C: both methods give the same onset at A = {} rad", amplitude),
                       margin_onset_phi},
                      shift, runs, 0);
}

bool has_gravity(const FigureRun& run) {
  return number_of(run, "gravity_m_per_s2") != 0;
}

/// A colour for each amplitude; open symbols without gravity.
std::vector<CurveStyle> styles_for(std::span<const FigureRun> runs) {
  static const std::array<const char*, 4> colours = {"#0072b2", "#d55e00", "#009e73", "#000000"};
  std::vector<CurveStyle> styles;
  std::size_t k = 0;
  for (const auto& [amplitude, members] : runs_by(runs, "amplitude_rad")) {
    const char* colour = colours[k % colours.size()];
    const int open = 4 + 2 * static_cast<int>(k % 4);
    std::set<double> gravities;
    for (const FigureRun* run : members) gravities.insert(number_of(*run, "gravity_m_per_s2"));
    for (const bool has : {true, false}) {
      const auto fits = [has](double gravity) { return (gravity != 0) == has; };
      if (std::ranges::count_if(gravities, fits) != 1) continue;
      styles.push_back(
          {{{"amplitude_rad", amplitude},
            {"gravity_m_per_s2", *std::ranges::find_if(gravities, fits)}},
           formula(fmt::format("$A$ = {}, {}", amplitude, has ? "gravity" : "no gravity")),
           colour,
           has ? open + 1 : open});
    }
    ++k;
  }
  return styles;
}

struct CurveOnset {
  const Curve* curve;
  double amplitude;
  bool gravity;
  Onset onset;
};

std::vector<CurveOnset> onsets_of(std::span<const Curve> curves) {
  std::vector<CurveOnset> onsets;
  for (const Curve& curve : curves) {
    const FigureRun& run = *curve.runs.front();
    onsets.push_back({&curve, number_of(run, "amplitude_rad"), has_gravity(run),
                      onset(curve.runs, onset_by_size)});
  }
  return onsets;
}

/// A black point on each curve, as in the supplement.
Series onset_series(std::span<const CurveOnset> onsets) {
  Series series{.title = "onset", .colour = "#000000"};
  for (const CurveOnset& o : onsets) {
    if (!o.onset.phi.mean) continue;
    series.points.push_back({*o.onset.cycle.mean, *o.onset.phi.mean, {}, o.onset.phi_error});
  }
  return series;
}

FigureTable onset_table(std::span<const CurveOnset> onsets) {
  FigureTable table{
      .name = "S6_onset",
      .columns = onset_columns({"variant", "amplitude_rad", "gravity", "onset_cycle_mean"})};
  for (const CurveOnset& o : onsets) {
    table.rows.push_back(onset_row(
        {o.curve->variant, o.amplitude, o.gravity ? "on" : "off", o.onset.cycle.mean}, o.onset));
  }
  table.chart = {
      .x = amplitude_axis,
      .y = onset_axis,
      .series = {onset_points("gravity", "#000000", 5, "amplitude_rad", {"gravity", "on"}),
                 onset_points("no gravity", "#d55e00", 7, "amplitude_rad", {"gravity", "off"})},
      .lines = onset_lines()};
  return table;
}

/// Figure 5(c) of the main text shows a slight difference in structure; the supplement does not say
/// in which quantity.
std::vector<FigureTable> structure_panels(std::span<const Curve> curves) {
  std::vector<FigureTable> panels = {
      against_phi("S6_crystalline", curves, {"crystalline", "percent", "crystalline_percent"},
                  crystalline_axis),
      against_phi("S6_contacts", curves, {"contacts_per_grain", "", "contacts_per_grain"},
                  {.name = "contacts per grain"}),
      against_phi("S6_overlap", curves, {"overlap", "d", "mean_overlap_d"}, overlap_axis)};
  for (FigureTable& panel : panels) panel.chart.lines = onset_lines(true);
  return panels;
}

/// The slope of phi at the onset against ln N_inves, by least squares over the runs that have one.
Verdict onset_is_of_any_size(std::span<const FigureRun> runs) {
  std::vector<std::pair<double, double>> points;  // ln N_inves and phi
  std::set<double> sizes;
  FigureTable entered = entered_with({"interior_grains", "onset_phi"});
  for (const FigureRun& run : runs) {
    const RunOnset onset = onset_by_size(run);
    if (onset.observed != Observed::yes) continue;
    const double interior = run.checkpoints.front().measures.number("interior_grains");
    if (!(interior > 0)) continue;
    points.emplace_back(std::log(interior), onset.phi);
    sizes.insert(number_of(run, "grains"));
    enter(run, {interior, onset.phi}, entered);
  }
  const auto slope = [&](std::span<const std::size_t> selection) {
    std::vector<std::pair<double, double>> chosen;
    for (const std::size_t k : selection) chosen.push_back(points[k]);
    return least_squares_slope(chosen);
  };
  return decide({"C: phi at the onset does not depend on the size of the cell", margin_onset_slope},
                "change of phi at the onset with ln N_inves",
                sizes.size() < 2 ? std::nullopt : bootstrapped(points.size(), slope), points.size(),
                fmt::format("{} of {} runs have their onset, in cells of {}", points.size(),
                            runs.size(), counted(sizes.size(), "size")),
                std::move(entered));
}

}  // namespace

FigureResult figure_s5a(std::span<const FigureRun> runs) {
  const Amplitudes amplitudes = runs_by(runs, "amplitude_rad");
  FigureResult result{{amplitude_table(amplitudes)}, {}};
  for (const auto& [amplitude, members] : amplitudes) {
    if (amplitude <= small_amplitude_rad) {
      result.verdicts.push_back(onset_is_published(
          members, fmt::format("C: the onset at A = {} rad is phi = 0.646", amplitude)));
    }
    result.verdicts.push_back(methods_agree(amplitude, members));
  }
  return result;
}

FigureResult figure_s5b(std::span<const FigureRun> runs) {
  FigureTable table{
      .name = "S5b",
      .columns = onset_columns({"grains", "interior_grains", "supplement_interior_grains"})};
  FigureResult result;
  bool converged = false;
  const auto groups = runs_by(runs, "grains");
  for (const auto& [grains, members] : groups) {
    const double interior = at_start(members, "interior_grains");
    table.rows.push_back(
        onset_row({grains, interior, published_interior(grains)}, onset(members, onset_by_size)));
    if (published_interior(grains)) {
      result.verdicts.push_back(interior_is_published(grains, members));
    }
    const bool small = std::ranges::all_of(members, [](const FigureRun* run) {
      return number_of(*run, "amplitude_rad") <= small_amplitude_rad;
    });
    if (small && interior >= converged_interior_grains) {
      converged = true;
      result.verdicts.push_back(onset_is_published(
          members, fmt::format("C: the onset at N = {} is phi = 0.646", grains)));
    }
  }
  if (!converged) {
    result.verdicts.push_back(
        onset_is_published({}, "C: the onset for N_inves >= 6000 is phi = 0.646"));
  }
  const double always_claimed = published_sizes.front().grains;
  if (!groups.contains(always_claimed)) {
    result.verdicts.push_back(interior_is_published(always_claimed, {}));
  }
  if (groups.size() > 1) result.verdicts.push_back(onset_is_of_any_size(runs));
  constexpr double most_grains = 20000;
  table.chart = {
      .x = {.name = "grains", .symbol = formula("$N$"), .low = 0, .high = most_grains},
      .y = onset_axis,
      .series = {onset_points("simulated", "#000000", 5, "grains"),
                 {.title = formula("experiment, $A$ = 0.01"),
                  .colour = "#e69f00",
                  .point = 0,
                  .join = Join::line,
                  .points = {{0, experiment_onset_phi}, {most_grains, experiment_onset_phi}}}},
      .lines = onset_lines()};
  result.tables.push_back(std::move(table));
  return result;
}

FigureResult figure_s6(std::span<const FigureRun> runs) {
  const std::vector<CurveStyle> styles = styles_for(runs);
  const std::vector<Curve> curves = curves_of(runs, styles);
  const std::vector<CurveOnset> onsets = onsets_of(curves);
  const std::array<MeasureColumn, 3> measures = {
      {{"phi", "", "phi"}, {"phi_u", "", "phi_uncorrected"}, {"overlap", "d", "mean_overlap_d"}}};
  FigureTable phi = against_cycle("S6", curves, measures, phi_axis);
  phi.chart.lines = onset_lines();
  phi.chart.series.push_back(onset_series(onsets));
  FigureResult result{{std::move(phi), onset_table(onsets)}, {}};
  std::ranges::move(structure_panels(curves), std::back_inserter(result.tables));
  bool small = false;
  for (const CurveOnset& o : onsets) {
    if (o.gravity) continue;
    if (o.amplitude <= small_amplitude_rad) {
      small = true;
      result.verdicts.push_back(onset_is_published(
          o.curve->runs,
          fmt::format("D: without gravity the onset at A = {} rad is phi = 0.646", o.amplitude)));
    }
    const auto with = std::ranges::find_if(onsets, [&](const CurveOnset& other) {
      return other.gravity && other.amplitude == o.amplitude;
    });
    const RunGroup others = with == onsets.end() ? RunGroup() : with->curve->runs;
    result.verdicts.push_back(
        compare({fmt::format("D: the onset at A = {} rad is the same with and without gravity",
                             o.amplitude),
                 margin_onset_phi},
                onset_phi(), o.curve->runs, others));
    result.verdicts.push_back(
        compare({fmt::format("D: percentage crystalline against phi at A = {} rad is the same with "
                             "and without gravity",
                             o.amplitude),
                 margin_percentage},
                over_phi("percentage crystalline", "crystalline_percent", window_low, window_high),
                o.curve->runs, others));
  }
  if (!small) {
    result.verdicts.push_back(onset_is_published(
        {}, "D: without gravity the onset at A = 0.04 and 0.05 rad is phi = 0.646"));
  }
  return result;
}

}  // namespace shearcell
