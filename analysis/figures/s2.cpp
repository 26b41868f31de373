// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S2: the form of the drag force changes how fast the grains compact, not the curve of
// crystallinity against packing fraction. Supplement B.3.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

const std::array<std::string, 2> variants = {"fluid=still", "fluid=cell"};

// Red triangles and black squares, as in the supplement.
const std::array<CurveStyle, 2> styles = {
    CurveStyle{"fluid=still", "{/:Italic v}_{fluid }= 0", "#d62728", 9},
    CurveStyle{"fluid=cell", "{/:Italic v}_{fluid }= {/:Italic v}_{cell}", "#000000", 5}};

RunStatistics over(const CurvePoint& point, double Measures::*quantity) {
  std::vector<double> values;
  values.reserve(point.runs.size());
  for (const Measures* measures : point.runs) values.push_back(measures->*quantity);
  return over_runs(values);
}

/// Short runs get a tick for every cycle and none between; gnuplot would halve them.
std::string whole_cycle_tics(std::span<const Curve> curves) {
  std::int64_t last = 0;
  for (const Curve& curve : curves) {
    if (!curve.points.empty()) last = std::max(last, curve.points.back().cycle);
  }
  return last <= 10 ? "set xtics 1\nunset mxtics\n" : "";
}

FigureTable phi_against_cycle(std::span<const Curve> curves) {
  FigureTable table;
  table.name = "S2a";
  table.columns = {
      "variant", "cycle", "phi_mean", "phi_standard_error", "phi_u_mean", "phi_u_standard_error",
      "runs"};
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      const RunStatistics phi = over(point, &Measures::phi);
      const RunStatistics phi_u = over(point, &Measures::phi_uncorrected);
      table.rows.push_back({curve.variant, point.cycle, table_value(phi.mean),
                            table_value(phi.standard_error), table_value(phi_u.mean),
                            table_value(phi_u.standard_error),
                            static_cast<std::int64_t>(phi.runs)});
    }
  }
  table.plot =
      "set xlabel 'shear cycle  {/:Italic n}'\n"
      "set ylabel 'volume fraction  {/:Italic ϕ}'\n" +
      whole_cycle_tics(curves) +
      plot_curves(curves, styles, {.x = 2, .x_error = 0, .y = 3, .y_error = 4});
  return table;
}

FigureTable crystallinity_against_phi(std::span<const Curve> curves) {
  FigureTable table;
  table.name = "S2b";
  table.columns = {"variant",
                   "cycle",
                   "phi_mean",
                   "phi_standard_error",
                   "crystalline_mean_percent",
                   "crystalline_standard_error_percent",
                   "runs"};
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      const RunStatistics phi = over(point, &Measures::phi);
      const RunStatistics crystalline = over(point, &Measures::crystalline_percent);
      table.rows.push_back({curve.variant, point.cycle, table_value(phi.mean),
                            table_value(phi.standard_error), table_value(crystalline.mean),
                            table_value(crystalline.standard_error),
                            static_cast<std::int64_t>(phi.runs)});
    }
  }
  table.plot =
      "set xlabel 'volume fraction  {/:Italic ϕ}'\n"
      "set ylabel 'percentage crystalline  [%]'\n"
      "set yrange [0:*]\n"
      "set offsets graph 0.03, graph 0.03, graph 0.05, 0\n" +
      plot_curves(curves, styles, {.x = 3, .x_error = 4, .y = 5, .y_error = 6});
  return table;
}

}  // namespace

std::vector<FigureTable> figure_s2(std::span<const FigureRun> runs) {
  const std::vector<Curve> curves = curves_by_cycle(runs, variants);
  return {phi_against_cycle(curves), crystallinity_against_phi(curves)};
}

}  // namespace shearcell
