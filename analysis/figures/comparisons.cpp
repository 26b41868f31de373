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
      {{{"fluid", "still"}}, fluid_is("0"), "#d55e00", 9},
      {{{"fluid", "cell"}}, fluid_is(italic("v") + subscript("cell")), "#000000", 5}};
  const auto curves = curves_of(runs, styles);
  return {{phi_against_cycle("S2a", curves), crystallinity_against_phi("S2b", curves)},
          similar("B.3", "both drags", runs_with(curves, styles[1].where),
                  runs_with(curves, styles[0].where))};
}

FigureResult figure_s3(Runs runs) {
  // By the number of steps in a cycle of 2 s. The last two are ours: 0.81 and 0.90 of the largest
  // stable step.
  const std::vector<CurveStyle> styles = {
      {{{"steps_per_cycle", 76923}}, seconds("2.6"), "#000000", 5},
      {{{"steps_per_cycle", 57143}}, seconds("3.5"), "#d55e00", 7},
      {{{"steps_per_cycle", 45600}}, seconds("4.4"), "#0072b2", 9},
      {{{"steps_per_cycle", 28571}}, seconds("7.0"), "#009e73", 11},
      {{{"steps_per_cycle", 20000}}, seconds("10.0"), "#cc79a7", 13},
      {{{"steps_per_cycle", 18000}}, seconds("11.1"), "#e69f00", 4}};
  const auto curves = curves_of(runs, styles);
  const RunGroup main_text = runs_with(curves, {{"steps_per_cycle", 45600}});
  std::vector<Verdict> verdicts;
  const auto add = [&](std::vector<Verdict> more) {
    std::ranges::move(more, std::back_inserter(verdicts));
  };
  const auto steps_of = [](const char* step) {
    return fmt::format("steps of {} and 4.4e-5 s", step);
  };
  for (const auto& [steps, step] :
       {std::pair(76923, "2.6e-5"), std::pair(57143, "3.5e-5"), std::pair(28571, "7.0e-5")}) {
    if (const RunGroup other = runs_with(curves, {{"steps_per_cycle", steps}}); !other.empty()) {
      add(similar("B.4", steps_of(step), other, main_text));
    }
  }
  verdicts.push_back(compare_with(
      {"B.4: at 4.4e-5 s the average overlap is less than 1e-3", published_overlap, Claimed::below},
      over_cycles("mean overlap [d]", "mean_overlap_d", 1, early_cycles), main_text, 0));
  for (const auto& [steps, step] : {std::pair(20000, "1.0e-4"), std::pair(18000, "1.11e-4")}) {
    if (const RunGroup other = runs_with(curves, {{"steps_per_cycle", steps}}); !other.empty()) {
      add(equal_physics(steps_of(step), other, main_text));
    }
  }
  return {{phi_against_cycle("S3a", curves), crystallinity_against_phi("S3b", curves)},
          std::move(verdicts)};
}

FigureResult figure_s4(Runs runs) {
  const std::vector<CurveStyle> styles = {
      {{{"moving_wall", "bottom"}, {"pressure_at", "top"}}, "top fixed", "#d55e00", 9},
      {{{"moving_wall", "top"}}, "top moves vertically", "#000000", 5},
      {{{"moving_wall", "bottom"}, {"pressure_at", "moving_wall"}},
       Text("top fixed, ") + italic("P") + " on the bottom wall",
       "#0072b2",
       11}};
  const auto curves = curves_of(runs, styles);
  const RunGroup top = runs_with(curves, styles[1].where);
  const RunGroup bottom = runs_with(curves, styles[0].where);
  std::vector<Verdict> verdicts = similar("B.6", "both moving walls", top, bottom);
  verdicts.push_back(
      same_contacts("B.6", "both moving walls", "mean overlap", "mean_overlap_d", top, bottom));
  verdicts.push_back(same_contacts("B.6", "both moving walls", "contacts per grain",
                                   "contacts_per_grain", top, bottom));
  return {{phi_against_cycle("S4a", curves), crystallinity_against_phi("S4b", curves)},
          std::move(verdicts)};
}

FigureResult figure_b5(Runs runs) {
  const std::vector<CurveStyle> styles = {
      {{{"protocol", "continuous"}}, "continuous shear", "#000000", 5},
      {{{"protocol", "paused"}}, "periodically paused shear", "#d55e00", 7}};
  const auto curves = curves_of(runs, styles);
  const RunGroup paused = runs_with(curves, styles[1].where);
  const RunGroup continuous = runs_with(curves, styles[0].where);
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
  const std::vector<CurveStyle> styles = {{{{"walls", "rough"}}, "rough walls", "#000000", 5},
                                          {{{"walls", "smooth"}}, "smooth walls", "#d55e00", 7}};
  const auto curves = curves_of(runs, styles);
  const RunGroup rough = runs_with(curves, styles[0].where);
  const RunGroup smooth = runs_with(curves, styles[1].where);
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
  const auto choice = [](double mass, double drag, int draw) {
    return nlohmann::json{{"wall_mass_grains_per_d2", mass * default_wall_mass},
                          {"wall_drag_grains_per_d2_s", drag * default_wall_drag},
                          {"wall_grain_draw", draw}};
  };
  const std::vector<CurveStyle> styles = {{choice(1, 1, 0), "default", "#000000", 5},
                                          {choice(3, 1, 0), "wall mass ×3", "#d55e00", 9},
                                          {choice(1. / 3, 1, 0), "wall mass /3", "#d55e00", 8},
                                          {choice(1, 3, 0), "wall drag ×3", "#0072b2", 11},
                                          {choice(1, 1. / 3, 0), "wall drag /3", "#0072b2", 10},
                                          {choice(1, 1, 1), "other wall grains", "#009e73", 7}};
  const auto curves = curves_of(runs, styles);
  std::vector<Verdict> verdicts;
  const RunGroup reference = runs_with(curves, styles[0].where);
  for (std::size_t k = 1; k < styles.size(); ++k) {
    verdicts.push_back(same_early_phi("choice", "the default and " + plain_text(styles[k].title),
                                      runs_with(curves, styles[k].where), reference));
  }
  return {{phi_against_cycle("choices", curves)}, std::move(verdicts)};
}

}  // namespace shearcell
