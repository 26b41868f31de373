// SPDX-License-Identifier: GPL-3.0-or-later
// Runs grouped into the curves of a figure: one per variant, one point per cycle, averaged over
// runs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"

namespace shearcell {

/// All checkpoints of one variant at the end of one cycle, one per run.
struct CurvePoint {
  std::int64_t cycle;
  std::vector<const Measures*> runs;
};

struct Curve {
  std::string variant;
  std::vector<CurvePoint> points;  ///< by cycle
};

/// Checkpoints inside a cycle are left out. Variants come in the order of `known`, then any others
/// by name. Throws AnalysisError when one run has two checkpoints of one cycle. Points into `runs`.
std::vector<Curve> curves_by_cycle(std::span<const FigureRun> runs,
                                   std::span<const std::string> known);

/// How a curve is drawn, following the supplement.
struct CurveStyle {
  std::string variant;
  std::string title;   ///< gnuplot enhanced text
  std::string colour;  ///< "#rrggbb"
  int point;           ///< gnuplot point type
};

/// gnuplot commands: lines with points and, where there is an error, error bars, for each curve
/// that is present. Columns are counted from 1; column 1 holds the variant. 0 for `x_error` means
/// that there is none.
struct CurveColumns {
  int x;
  int x_error;
  int y;
  int y_error;
};
std::string plot_curves(std::span<const Curve> curves, std::span<const CurveStyle> styles,
                        const CurveColumns& columns);

}  // namespace shearcell
