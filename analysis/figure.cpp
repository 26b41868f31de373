// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figure.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

constexpr auto scalars = FigureNeeds::scalars;

const std::vector<Figure>& figures() {
  constexpr auto crystallites = FigureNeeds::crystallites;
  constexpr auto curves = FigureForm::curves;
  constexpr auto groups = FigureForm::groups;
  static const std::vector<Figure> all = {
      {"table1",
       "Table I beside the parameters of every experiment",
       FigureNeeds::none,
       figure_table1,
       FigureForm::table,
       {}},
      {"S1",
       "Packing fraction in the limit of hard grains",
       scalars,
       figure_s1,
       groups,
       {"pressure_at"}},
      {"S2",
       "Still fluid and fluid that moves with the cell",
       scalars,
       figure_s2,
       curves,
       {"fluid"}},
      {"S3", "Time steps", scalars, figure_s3, curves, {"steps_per_cycle"}},
      {"S4",
       "Moving bottom wall and moving top wall",
       scalars,
       figure_s4,
       curves,
       {"moving_wall", "pressure_at"}},
      {"S5a",
       "Onset of crystallization against amplitude",
       scalars,
       figure_s5a,
       groups,
       {"amplitude_rad"}},
      {"S5b",
       "Onset of crystallization against system size",
       scalars,
       figure_s5b,
       groups,
       {"grains"}},
      {"S6",
       "Shear with and without gravity",
       scalars,
       figure_s6,
       curves,
       {"amplitude_rad", "gravity_m_per_s2"}},
      {"S7",
       "Where crystallites nucleate",
       crystallites,
       figure_s7,
       groups,
       {"amplitude_rad", "stiffness_N_per_m"}},
      {"C", "Growth of crystallites by size", crystallites, figure_c, groups, {"amplitude_rad"}},
      {"nucleation",
       "Runs without an onset, and the rate of nucleation",
       scalars,
       figure_nucleation,
       groups,
       {"amplitude_rad", "grains"}},
      {"B5",
       "Continuous and periodically paused shear",
       scalars,
       figure_b5,
       curves,
       {"protocol"},
       true},
      {"walls", "Rough and smooth walls", scalars, figure_walls, curves, {"walls"}},
      {"choices",
       "Mass and drag of the moving wall, and other wall grains",
       scalars,
       figure_choices,
       curves,
       {"wall_mass_grains_per_d2", "wall_drag_grains_per_d2_s", "wall_grain_draw"}}};
  return all;
}

}  // namespace

bool Figure::needs_derived(std::string_view measure) const {
  return std::ranges::find(derived, measure) != derived.end();
}

nlohmann::json parameter_of(const FigureRun& run, const std::string& key) {
  for (const nlohmann::json* values : {&run.labels, &run.parameters}) {
    if (values->is_object() && values->contains(key)) return values->at(key);
  }
  return nullptr;
}

double number_of(const FigureRun& run, const std::string& key) {
  const nlohmann::json value = parameter_of(run, key);
  return value.is_number() ? value.get<double>() : std::nan("");
}

std::vector<std::string> keys_telling_apart(std::span<const nlohmann::json> variants,
                                            std::vector<std::string> keys) {
  const auto distinct = [&](const std::vector<std::string>& used) {
    std::set<std::vector<nlohmann::json>> tuples;
    for (const nlohmann::json& variant : variants) {
      std::vector<nlohmann::json> tuple;
      for (const std::string& key : used) tuple.push_back(variant.value(key, nlohmann::json()));
      tuples.insert(std::move(tuple));
    }
    return tuples.size();
  };
  const std::size_t all = distinct(keys);
  for (std::size_t k = keys.size(); k-- > 0;) {
    std::vector<std::string> fewer = keys;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
    if (distinct(fewer) == all) keys = std::move(fewer);
  }
  return keys;
}

std::vector<std::string> varied_keys(std::span<const FigureRun> runs) {
  std::set<nlohmann::json> variants;
  std::set<std::string> keys;
  for (const FigureRun& run : runs) {
    if (!run.labels.is_object()) continue;
    variants.insert(run.labels);
    for (const auto& [key, value] : run.labels.items()) keys.insert(key);
  }
  const std::vector<nlohmann::json> list(variants.begin(), variants.end());
  return keys_telling_apart(list, {keys.begin(), keys.end()});
}

std::span<const Figure> all_figures() {
  return figures();
}

const Figure* find_figure(std::string_view name) {
  const auto found = std::ranges::find(figures(), name, &Figure::name);
  return found == figures().end() ? nullptr : &*found;
}

}  // namespace shearcell
