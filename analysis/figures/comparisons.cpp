// SPDX-License-Identifier: GPL-3.0-or-later
// The figures that compare the variants of one parameter: S2, S3, S4, B5, walls and choices. They
// differ in the parameter, the styles of the curves, the panels and the claims.
#include <fmt/format.h>

#include <cmath>

#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

using Runs = std::span<const FigureRun>;
using Curves = std::span<const Curve>;

struct Panel {
  const char* name;
  FigureTable (*draw)(const std::string& name, Curves curves);
};

FigureResult compare(Curves curves, std::initializer_list<Panel> panels,
                     std::vector<Verdict> verdicts) {
  FigureResult result{{}, std::move(verdicts)};
  for (const Panel& panel : panels) result.tables.push_back(panel.draw(panel.name, curves));
  return result;
}

/// The two claims that S2, S3 and S4 share.
std::vector<Verdict> similar_then_one_curve(Curves curves, const char* section, const char* what,
                                            std::int64_t until) {
  return {phi_agrees_until(curves, until,
                           fmt::format("{}: phi against cycle is similar for {} until cycle {}",
                                       section, what, until)),
          crystallinity_agrees(
              curves, fmt::format("{}: percentage crystalline against phi is one curve for {}",
                                  section, what))};
}

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

/// "v_fluid = ..."
Text fluid_is(const Text& velocity) {
  return italic("v") + subscript("fluid") + " = " + velocity;
}

Text seconds(const char* mantissa) {
  return Text(mantissa) + "×10" + superscript("−5") + " s";
}

}  // namespace

// Symbols and colours of S2, S3 and S4 are those of the supplement.

FigureResult figure_s2(Runs runs) {
  const std::vector<CurveStyle> styles = {
      {"still", fluid_is("0"), "#d62728", 9},
      {"cell", fluid_is(italic("v") + subscript("cell")), "#000000", 5}};
  const auto curves = curves_of(runs, "fluid", styles);
  return compare(curves, {{"S2a", phi_against_cycle}, {"S2b", crystallinity_against_phi}},
                 similar_then_one_curve(curves, "B.3", "both drags", 60));
}

FigureResult figure_s3(Runs runs) {
  // By the number of steps in a cycle of 2 s.
  const std::vector<CurveStyle> styles = {{76923, seconds("2.6"), "#000000", 5},
                                          {57143, seconds("3.5"), "#d62728", 7},
                                          {45600, seconds("4.4"), "#1f4fd8", 9},
                                          {28571, seconds("7.0"), "#2ca02c", 11}};
  const auto curves = curves_of(runs, "steps_per_cycle", styles);
  std::vector<Verdict> verdicts = similar_then_one_curve(curves, "B.4", "all time steps", 30);
  verdicts.push_back(overlap_is_small(curves));
  return compare(curves, {{"S3a", phi_against_cycle}, {"S3b", crystallinity_against_phi}},
                 std::move(verdicts));
}

FigureResult figure_s4(Runs runs) {
  const std::vector<CurveStyle> styles = {{"bottom", "top fixed", "#d62728", 9},
                                          {"top", "top moves vertically", "#000000", 5}};
  const auto curves = curves_of(runs, "moving_wall", styles);
  return compare(curves, {{"S4a", phi_against_cycle}, {"S4b", crystallinity_against_phi}},
                 similar_then_one_curve(curves, "B.6", "both moving walls", 40));
}

FigureResult figure_b5(Runs runs) {
  const std::vector<CurveStyle> styles = {{"continuous", "continuous shear", "#000000", 5},
                                          {"paused", "periodically paused shear", "#d62728", 7}};
  const auto curves = curves_of(runs, "protocol", styles);
  return compare(
      curves,
      {{"B5a", phi_against_cycle},
       {"B5b", crystallinity_against_cycle},
       {"B5c", crystallinity_against_phi}},
      {pauses_compact_faster(curves),
       crystallinity_agrees(
           curves, "B.5: percentage crystalline against phi is similar for both relaxations")});
}

// Not in the supplement, which says only that crystallites appear away from the walls (E).
FigureResult figure_walls(Runs runs) {
  const std::vector<CurveStyle> styles = {{"rough", "rough walls", "#000000", 5},
                                          {"smooth", "smooth walls", "#d62728", 7}};
  const auto curves = curves_of(runs, "walls", styles);
  return compare(curves,
                 {{"walls_a", phi_against_cycle},
                  {"walls_b", crystallinity_against_cycle},
                  {"walls_c", crystallinity_against_phi}},
                 wall_verdicts(curves));
}

FigureResult figure_choices(Runs runs) {
  const std::vector<CurveStyle> styles = {{unchanged, "default", "#000000", 5},
                                          {"wall mass ×3", "wall mass ×3", "#d62728", 9},
                                          {"wall mass /3", "wall mass /3", "#d62728", 8},
                                          {"wall drag ×3", "wall drag ×3", "#1f4fd8", 11},
                                          {"wall drag /3", "wall drag /3", "#1f4fd8", 10},
                                          {"other wall grains", "other wall grains", "#2ca02c", 7}};
  const auto curves = curves_by(runs, choice_of, styles);
  std::vector<Verdict> verdicts;
  const Curve* reference = curve_with(curves, unchanged);
  for (std::size_t k = 1; k < styles.size(); ++k) {
    std::vector<Curve> pair;
    for (const Curve* curve : {reference, curve_with(curves, styles[k].value)}) {
      if (curve != nullptr) pair.push_back(*curve);
    }
    verdicts.push_back(
        phi_agrees_until(pair, compared_until,
                         fmt::format("choice: phi against cycle is the same until cycle {} with {}",
                                     compared_until, styles[k].value.get<std::string>()),
                         styles.size() - 1));
  }
  return compare(curves, {{"choices", phi_against_cycle}}, std::move(verdicts));
}

}  // namespace shearcell
