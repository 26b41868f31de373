// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S6: grains crystallize at the same packing fraction with and without gravity. Supplement
// D.
#include <fmt/format.h>

#include <array>

#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/onset.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

/// The values in which the curves differ.
nlohmann::json group_of(double amplitude, bool gravity) {
  return nlohmann::json::array({amplitude, gravity});
}

Text title_of(double amplitude, bool gravity) {
  return italic("A") + fmt::format(" = {}, {}", amplitude, gravity ? "gravity" : "no gravity");
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
    for (const bool gravity : {true, false}) {
      styles.push_back({group_of(amplitude, gravity), title_of(amplitude, gravity), colour,
                        gravity ? open + 1 : open});
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
    const double amplitude = number_of(*curve.runs.front(), "amplitude_rad");
    onsets.push_back(
        {&curve, amplitude, has_gravity(*curve.runs.front()),
         onset(curve.runs, onset_by_size, published_nearest(amplitude).critical_size)});
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
  FigureTable table;
  table.name = "S6_onset";
  table.columns = onset_columns({"variant", "amplitude_rad", "gravity", "onset_cycle_mean"});
  for (const CurveOnset& o : onsets) {
    table.rows.push_back(
        onset_row({o.curve->variant, o.amplitude, std::string(o.gravity ? "on" : "off"),
                   table_value(o.onset.cycle.mean)},
                  o.onset));
  }
  const auto with = [](const char* title, const char* colour, int point, const char* gravity) {
    return Series{.title = title,
                  .colour = colour,
                  .point = point,
                  .columns = {.x = "amplitude_rad",
                              .y = "onset_phi_mean",
                              .y_error = "onset_phi_standard_error"},
                  .filter = {"gravity", std::string(gravity)}};
  };
  table.chart = {
      .x = amplitude_axis(),
      .y = onset_axis(),
      .series = {with("gravity", "#000000", 5, "on"), with("no gravity", "#d55e00", 7, "off")},
      .lines = onset_lines()};
  return table;
}

/// Figure 5(c) of the main text shows a slight difference in structure; the supplement does not say
/// in which quantity.
std::vector<FigureTable> structure_panels(std::span<const Curve> curves) {
  std::vector<FigureTable> panels = {
      crystallinity_against_phi("S6_crystalline", curves),
      against_phi("S6_contacts", curves, {"contacts_per_grain", "", &Measures::contacts_per_grain},
                  {.name = "contacts per grain"}),
      against_phi("S6_overlap", curves, {"overlap", "d", &Measures::mean_overlap}, overlap_axis())};
  for (FigureTable& panel : panels) {
    for (ReferenceLine line : onset_lines()) {
      line.vertical = true;
      panel.chart.lines.push_back(line);
    }
  }
  return panels;
}

/// The claims on one amplitude; `with` may be null.
std::vector<Verdict> claims_on(double amplitude, const Curve& without, const Curve* with) {
  std::vector<Verdict> verdicts = {onset_is_published(
      without.runs,
      fmt::format("D: without gravity the onset at A = {} rad is phi = 0.646", amplitude))};
  if (with == nullptr) return verdicts;
  verdicts.push_back(compare(
      {fmt::format("D: the onset at A = {} rad is the same with and without gravity", amplitude),
       margin_onset_phi.value},
      onset_phi(onset_by_size), without.runs, with->runs));
  verdicts.push_back(compare({fmt::format("D: percentage crystalline against phi at A = {} rad is "
                                          "the same with and without gravity",
                                          amplitude),
                              margin_percentage.value},
                             percentage_over_phi(), without.runs, with->runs));
  return verdicts;
}

}  // namespace

FigureResult figure_s6(std::span<const FigureRun> runs) {
  const std::vector<Curve> curves = curves_by(
      runs, find_figure("S6")->keys,
      [](const FigureRun& run) {
        return group_of(number_of(run, "amplitude_rad"), has_gravity(run));
      },
      styles_for(runs));
  const std::vector<CurveOnset> onsets = onsets_of(curves);
  FigureTable phi = phi_against_cycle("S6", curves);
  phi.chart.lines = onset_lines();
  phi.chart.series.push_back(onset_series(onsets));
  FigureResult result{{std::move(phi), onset_table(onsets)}, {}};
  for (FigureTable& panel : structure_panels(curves)) result.tables.push_back(std::move(panel));
  for (const CurveOnset& o : onsets) {
    if (o.gravity) continue;
    const Curve* with = curve_with(curves, group_of(o.amplitude, true));
    for (Verdict& verdict : claims_on(o.amplitude, *o.curve, with)) {
      result.verdicts.push_back(std::move(verdict));
    }
  }
  if (result.verdicts.empty()) {
    result.verdicts.push_back(
        onset_is_published({}, "D: without gravity the onset is phi = 0.646"));
  }
  return result;
}

}  // namespace shearcell
