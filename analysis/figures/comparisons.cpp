// SPDX-License-Identifier: GPL-3.0-or-later
// The figures that compare the variants of one parameter: S2, S3, S4, B5, walls and choices. They
// differ in the parameter, the styles of the curves, the panels and the claims.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

using Runs = std::span<const FigureRun>;

/// Compares a quantity of the cycles before crystallization. The note counts the runs whose onset
/// is earlier.
Verdict compare_early(const Claim& claim, const Scalar& scalar, RunGroup a, RunGroup b) {
  Verdict verdict = compare(claim, scalar, a, b);
  std::size_t early = 0;
  for (const RunGroup group : {a, b}) {
    for (const Waiting& wait : waits_for_onset(group)) {
      early += wait.observed && wait.cycle < static_cast<double>(early_cycles) ? 1 : 0;
    }
  }
  if (early > 0) {
    verdict.note += fmt::format("; {} of all {} runs have their onset before cycle {}", early,
                                a.size() + b.size(), early_cycles);
  }
  return verdict;
}

Verdict same_early_phi(const std::string& section, const std::string& what, RunGroup a,
                       RunGroup b) {
  return compare_early(
      {fmt::format("{}: phi is the same at cycles 1 to {} for {}", section, early_cycles, what),
       margin_early_phi},
      early_phi(), a, b);
}

Verdict same_percentage(const std::string& section, const std::string& what, RunGroup a,
                        RunGroup b) {
  return compare(
      {fmt::format("{}: percentage crystalline against phi is the same for {}", section, what),
       margin_percentage},
      percentage_over_phi(), a, b);
}

/// What S2, S3 and S4 claim of two variants. Single runs crystallize at random cycles, so phi at
/// later cycles is compared by the cycle of the onset.
std::vector<Verdict> similar(const std::string& section, const std::string& what, RunGroup a,
                             RunGroup b) {
  return {
      same_early_phi(section, what, a, b),
      compare_waits({fmt::format("{}: crystallization begins at the same cycle, within a factor "
                                 "of 2, for {}",
                                 section, what),
                     margin_onset_cycle},
                    "the onset", waits_for_onset, a, b),
      same_percentage(section, what, a, b)};
}

/// For the mean overlap or the contacts per grain.
Verdict same_contacts(const std::string& section, const std::string& what, const char* name,
                      const char* measure, RunGroup a, RunGroup b) {
  Scalar scalar = over_cycles(name, measure, 1, early_cycles);
  scalar.relative = true;
  return compare({fmt::format("{}: {} is the same for {}", section, name, what), margin_contacts},
                 scalar, a, b);
}

/// What a time step larger than those of Fig. S3 must leave unchanged to replace that of Table I.
std::vector<Verdict> equal_physics(const std::string& what, RunGroup a, RunGroup b) {
  const char* section = "time step";
  return {
      compare({fmt::format("{}: the onset is the same for {}", section, what), margin_onset_phi},
              onset_phi(), a, b),
      same_percentage(section, what, a, b),
      same_contacts(section, what, "mean overlap", "mean_overlap_d", a, b)};
}

// Defaults of a manifest (experiments/manifest/README.md); a test compares them.
constexpr double default_wall_mass = 10;    // [m/d^2]
constexpr double default_wall_drag = 1000;  // [m/(d^2 s)]

constexpr const char* unchanged = "default";
constexpr const char* lifting = "bottom, under P alone";

/// "wall mass ×3", "wall mass /3", or "".
std::string times(const char* what, double ratio) {
  if (!(std::abs(ratio - 1) > 1e-3)) return "";
  return ratio > 1 ? fmt::format("{} ×{:.3g}", what, ratio)
                   : fmt::format("{} /{:.3g}", what, 1 / ratio);
}

/// How the run differs from the default.
nlohmann::json choice_of(const FigureRun& run) {
  std::vector<std::string> parts = {
      times("wall mass", number_of(run, "wall_mass_grains_per_d2") / default_wall_mass),
      times("wall drag", number_of(run, "wall_drag_grains_per_d2_s") / default_wall_drag),
      number_of(run, "wall_grain_draw") != 0 ? "other wall grains" : ""};
  std::erase(parts, "");
  return parts.empty() ? unchanged : fmt::format("{}", fmt::join(parts, ", "));
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
      {"still", fluid_is("0"), "#d55e00", 9},
      {"cell", fluid_is(italic("v") + subscript("cell")), "#000000", 5}};
  const auto curves = curves_of(runs, "fluid", styles);
  return {{phi_against_cycle("S2a", curves), crystallinity_against_phi("S2b", curves)},
          similar("B.3", "both drags", runs_with(curves, "cell"), runs_with(curves, "still"))};
}

FigureResult figure_s3(Runs runs) {
  // By the number of steps in a cycle of 2 s. The last two are ours: 0.81 and 0.90 of the largest
  // stable step.
  const std::vector<CurveStyle> styles = {
      {76923, seconds("2.6"), "#000000", 5},   {57143, seconds("3.5"), "#d55e00", 7},
      {45600, seconds("4.4"), "#0072b2", 9},   {28571, seconds("7.0"), "#009e73", 11},
      {20000, seconds("10.0"), "#cc79a7", 13}, {18000, seconds("11.1"), "#e69f00", 4}};
  const auto curves = curves_of(runs, "steps_per_cycle", styles);
  const RunGroup main_text = runs_with(curves, 45600);
  std::vector<Verdict> verdicts;
  const auto add = [&](std::vector<Verdict> more) {
    std::ranges::move(more, std::back_inserter(verdicts));
  };
  const auto steps_of = [](const char* step) {
    return fmt::format("steps of {} and 4.4e-5 s", step);
  };
  for (const auto& [steps, step] :
       {std::pair(76923, "2.6e-5"), std::pair(57143, "3.5e-5"), std::pair(28571, "7.0e-5")}) {
    if (const RunGroup other = runs_with(curves, steps); !other.empty()) {
      add(similar("B.4", steps_of(step), other, main_text));
    }
  }
  verdicts.push_back(compare_with(
      {"B.4: at 4.4e-5 s the average overlap is less than 1e-3", published_overlap, Claimed::below},
      over_cycles("mean overlap [d]", "mean_overlap_d", 1, early_cycles), main_text, 0));
  for (const auto& [steps, step] : {std::pair(20000, "1.0e-4"), std::pair(18000, "1.11e-4")}) {
    if (const RunGroup other = runs_with(curves, steps); !other.empty()) {
      add(equal_physics(steps_of(step), other, main_text));
    }
  }
  return {{phi_against_cycle("S3a", curves), crystallinity_against_phi("S3b", curves)},
          std::move(verdicts)};
}

/// The wall that moves; `lifting` if the pressure alone also lifts the grains.
nlohmann::json load_of(const FigureRun& run) {
  nlohmann::json moves = parameter_of(run, "moving_wall");
  if (moves == "bottom" && parameter_of(run, "pressure_at") == "moving_wall") moves = lifting;
  return moves;
}

FigureResult figure_s4(Runs runs) {
  const std::vector<CurveStyle> styles = {
      {"bottom", "top fixed", "#d55e00", 9},
      {"top", "top moves vertically", "#000000", 5},
      {lifting, Text("top fixed, ") + italic("P") + " on the bottom wall", "#0072b2", 11}};
  const auto curves = curves_by(runs, find_figure("S4")->keys, load_of, styles);
  const RunGroup top = runs_with(curves, "top");
  const RunGroup bottom = runs_with(curves, "bottom");
  std::vector<Verdict> verdicts = similar("B.6", "both moving walls", top, bottom);
  verdicts.push_back(
      same_contacts("B.6", "both moving walls", "mean overlap", "mean_overlap_d", top, bottom));
  verdicts.push_back(same_contacts("B.6", "both moving walls", "contacts per grain",
                                   "contacts_per_grain", top, bottom));
  return {{phi_against_cycle("S4a", curves), crystallinity_against_phi("S4b", curves)},
          std::move(verdicts)};
}

FigureResult figure_b5(Runs runs) {
  const std::vector<CurveStyle> styles = {{"continuous", "continuous shear", "#000000", 5},
                                          {"paused", "periodically paused shear", "#d55e00", 7}};
  const auto curves = curves_of(runs, "protocol", styles);
  const RunGroup paused = runs_with(curves, "paused");
  const RunGroup continuous = runs_with(curves, "continuous");
  return {{phi_against_cycle("B5a", curves), crystallinity_against_cycle("B5b", curves),
           crystallinity_against_phi("B5c", curves)},
          {compare_early(
               {fmt::format("B.5: at cycles 1 to {} phi of paused shear is higher by more than {}",
                            early_cycles, margin_pause_gain),
                margin_pause_gain, Claimed::above},
               over_cycles("phi at rest", "phi_at_rest", 1, early_cycles), paused, continuous),
           same_percentage("B.5", "both relaxations", paused, continuous)}};
}

// Not in the supplement, which says only that crystallites appear away from the walls (E).
FigureResult figure_walls(Runs runs) {
  const std::vector<CurveStyle> styles = {{"rough", "rough walls", "#000000", 5},
                                          {"smooth", "smooth walls", "#d55e00", 7}};
  const auto curves = curves_of(runs, "walls", styles);
  const RunGroup rough = runs_with(curves, "rough");
  const RunGroup smooth = runs_with(curves, "smooth");
  const auto fifth = [](RunGroup group) { return waits_for(group, "crystalline_percent", 20); };
  std::vector<Verdict> verdicts = {
      compare_waits({"walls: rough ones delay crystallization (20 % of the grains) by more than a "
                     "factor of 2",
                     margin_wall_delay, Claimed::above},
                    "20 % crystalline grains", fifth, rough, smooth),
      onset_is_published(rough, "walls: between rough ones the onset is phi = 0.646")};
  if (!rough.empty()) {
    const double grains = number_of(*rough.front(), "grains");
    if (published_interior(grains)) verdicts.push_back(interior_is_published(grains, rough));
  }
  return {{phi_against_cycle("walls_a", curves), crystallinity_against_cycle("walls_b", curves),
           crystallinity_against_phi("walls_c", curves)},
          std::move(verdicts)};
}

FigureResult figure_choices(Runs runs) {
  const std::vector<CurveStyle> styles = {{unchanged, "default", "#000000", 5},
                                          {"wall mass ×3", "wall mass ×3", "#d55e00", 9},
                                          {"wall mass /3", "wall mass /3", "#d55e00", 8},
                                          {"wall drag ×3", "wall drag ×3", "#0072b2", 11},
                                          {"wall drag /3", "wall drag /3", "#0072b2", 10},
                                          {"other wall grains", "other wall grains", "#009e73", 7}};
  const auto curves = curves_by(runs, find_figure("choices")->keys, choice_of, styles);
  std::vector<Verdict> verdicts;
  const RunGroup reference = runs_with(curves, unchanged);
  for (std::size_t k = 1; k < styles.size(); ++k) {
    verdicts.push_back(same_early_phi("choice",
                                      "the default and " + styles[k].value.get<std::string>(),
                                      runs_with(curves, styles[k].value), reference));
  }
  return {{phi_against_cycle("choices", curves)}, std::move(verdicts)};
}

}  // namespace shearcell
