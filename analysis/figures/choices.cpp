// SPDX-License-Identifier: GPL-3.0-or-later
// What this project chose where the supplement is silent must not show: phi against cycle for a
// moving wall of another mass or drag, and for other wall grains.
#include <fmt/format.h>

#include <cmath>

#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

constexpr std::int64_t compared_until = 40;

// What a manifest has when it does not say (experiments/manifest/README.md; a test compares).
constexpr double default_wall_mass = 10;    // [m/d^2]
constexpr double default_wall_drag = 1000;  // [m/(d^2 s)]

constexpr const char* unchanged = "default";

/// "wall mass ×3", "wall mass /3", or "".
std::string times(const char* what, double ratio) {
  if (!(std::abs(ratio - 1) > 1e-3)) return "";
  return ratio > 1 ? fmt::format("{} ×{:.3g}", what, ratio)
                   : fmt::format("{} /{:.3g}", what, 1 / ratio);
}

/// In what the run departs from the default. The default draw of wall grains is not recorded.
nlohmann::json choice_of(const FigureRun& run) {
  const double draw = number_of(run, "wall_grain_draw");
  std::string text;
  for (const std::string& part :
       {times("wall mass", number_of(run, "wall_mass_grains_per_d2") / default_wall_mass),
        times("wall drag", number_of(run, "wall_drag_grains_per_d2_s") / default_wall_drag),
        std::string(std::isfinite(draw) && draw != 0 ? "other wall grains" : "")}) {
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  }
  return text.empty() ? unchanged : text;
}

}  // namespace

FigureResult figure_choices(std::span<const FigureRun> runs) {
  static const std::vector<CurveStyle> styles = {
      {unchanged, "default", "#000000", 5},
      {"wall mass ×3", "wall mass ×3", "#d62728", 9},
      {"wall mass /3", "wall mass /3", "#d62728", 8},
      {"wall drag ×3", "wall drag ×3", "#1f4fd8", 11},
      {"wall drag /3", "wall drag /3", "#1f4fd8", 10},
      {"other wall grains", "other wall grains", "#2ca02c", 7}};
  const std::vector<Curve> curves = curves_by(runs, choice_of, styles);
  FigureResult result{{phi_against_cycle("choices", curves)}, {}};
  const Curve* reference = curve_with(curves, unchanged);
  for (std::size_t k = 1; k < styles.size(); ++k) {
    std::vector<Curve> pair;
    for (const Curve* curve : {reference, curve_with(curves, styles[k].value)}) {
      if (curve != nullptr) pair.push_back(*curve);
    }
    result.verdicts.push_back(
        phi_agrees_until(pair, compared_until,
                         fmt::format("choice: phi against cycle is the same until cycle {} with {}",
                                     compared_until, styles[k].title),
                         styles.size() - 1));
  }
  return result;
}

}  // namespace shearcell
