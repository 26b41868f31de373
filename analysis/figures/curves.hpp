// SPDX-License-Identifier: GPL-3.0-or-later
// Runs grouped into the curves of a figure: one per variant, one point per cycle, averaged over
// runs.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// How a curve is drawn, following the supplement. It belongs to the runs in which the figure's
/// parameter has this value; numbers match within 3 %, since a time step is a whole part of a
/// cycle.
struct CurveStyle {
  nlohmann::json value;
  std::string title;   ///< gnuplot enhanced text
  std::string colour;  ///< "#rrggbb"
  int point;           ///< gnuplot point type
};

/// All checkpoints of one variant at the end of one cycle, one per run.
struct CurvePoint {
  std::int64_t cycle;
  std::vector<const Measures*> runs;
};

struct Curve {
  std::string variant;   ///< as the manifest names it, with ';' for ','
  nlohmann::json value;  ///< of the figure's parameter; null when the runs do not say
  CurveStyle style;
  std::vector<const FigureRun*> runs;
  std::vector<CurvePoint> points;  ///< by cycle
};

/// Checkpoints inside a cycle are left out. Curves come in the order of the `styles` of
/// `parameter`, then any others by the variant's name. Throws AnalysisError when one run has two
/// checkpoints of one cycle. Points into `runs`.
std::vector<Curve> curves_of(std::span<const FigureRun> runs, const std::string& parameter,
                             std::span<const CurveStyle> styles);

/// The same where `value_of` a run, and not one parameter, decides the style.
std::vector<Curve> curves_by(std::span<const FigureRun> runs,
                             const std::function<nlohmann::json(const FigureRun&)>& value_of,
                             std::span<const CurveStyle> styles);

/// The curve in which the parameter has that value, or null.
const Curve* curve_with(std::span<const Curve> curves, const nlohmann::json& value);

RunStatistics over(const CurvePoint& point, double Measures::*quantity);

/// gnuplot commands: lines with points and, where there is an error, error bars, for each curve.
/// Many cycles are marked every 2, 5, 10, ... cycles; the line has them all.
std::string plot_curves(std::span<const Curve> curves, const CurveColumns& columns);

/// The same curves for a chart. Column 1 of the table holds the variant.
std::vector<ChartSeries> chart_curves(std::span<const Curve> curves, const TableRows& rows,
                                      const CurveColumns& columns);

/// One part of a plot command: points, and error bars where there is an error, which `yerrorbars`
/// alone would leave out with their points. `x` and `y` are gnuplot's `using` expressions.
std::string points_with_errors(const std::string& x, const std::string& y, int error_column,
                               const std::string& colour, int point, const std::string& title);

/// gnuplot's single-quoted text, in which only the quote itself means anything.
std::string literal(const std::string& text);

/// gnuplot commands: dashed horizontal lines at phi = 0.646 +- 0.001, the supplement's onset, and a
/// range of y that holds them.
std::string onset_lines();
/// Where they lie.
std::vector<double> onset_levels();

/// gnuplot commands for an axis of cycles. Short runs get a tick for every cycle.
std::string cycle_axis(std::span<const Curve> curves);

/// A row for each variant and cycle: phi, phi_u and the mean overlap.
FigureTable phi_against_cycle(const std::string& name, std::span<const Curve> curves);
/// A row for each variant and cycle: the percentage of crystalline grains.
FigureTable crystallinity_against_cycle(const std::string& name, std::span<const Curve> curves);
/// A row for each variant and bin of phi: the percentage of crystalline grains.
FigureTable crystallinity_against_phi(const std::string& name, std::span<const Curve> curves);

}  // namespace shearcell
