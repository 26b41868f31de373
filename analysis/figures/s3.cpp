// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S3: the time step changes how fast the grains compact, not the curve of crystallinity
// against packing fraction. Supplement B.4.
#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

constexpr double step_of_main_text = 45600;  // steps per cycle: 4.4e-5 s

Verdict overlap_is_small(std::span<const Curve> curves) {
  const Curve* curve = curve_with(curves, step_of_main_text);
  std::optional<double> overlap;
  if (curve != nullptr) overlap = over(curve->points.back(), &Measures::mean_overlap).mean;
  return below("B.4: at 4.4e-5 s the average overlap is less than 1e-3",
               "mean overlap at the last cycle [d]", overlap, 1e-3,
               curve == nullptr ? "no run has that time step" : "");
}

}  // namespace

FigureResult figure_s3(std::span<const FigureRun> runs) {
  // By steps in a cycle of 2 s. Symbols and colours of the supplement.
  static const std::vector<CurveStyle> styles = {{76923, "2.6×10^{-5} s", "#000000", 5},
                                                 {57143, "3.5×10^{-5} s", "#d62728", 7},
                                                 {45600, "4.4×10^{-5} s", "#1f4fd8", 9},
                                                 {28571, "7.0×10^{-5} s", "#2ca02c", 11}};
  const std::vector<Curve> curves = curves_of(runs, "steps_per_cycle", styles);
  FigureResult result = two_panels(
      curves, {.name = "S3", .section = "B.4", .what = "all time steps", .similar_until = 30});
  result.verdicts.push_back(overlap_is_small(curves));
  return result;
}

}  // namespace shearcell
