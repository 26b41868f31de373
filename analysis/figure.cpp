// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figure.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

using Make = FigureResult (*)(std::span<const FigureRun>);
using Keys = std::vector<std::string>;

/// A curve for each variant; `keys` are what they compare.
Figure of_curves(const char* name, const char* title, Make make, Keys keys,
                 std::vector<std::string> needs = {}) {
  return {name, title, make, FigureForm::curves, std::move(keys), std::move(needs)};
}

/// Averages over the variants that have the same values of `keys`.
Figure of_groups(const char* name, const char* title, Make make, Keys keys,
                 std::vector<std::string> needs = {}) {
  return {name, title, make, FigureForm::groups, std::move(keys), std::move(needs)};
}

}  // namespace

nlohmann::json parameter_of(const FigureRun& run, const std::string& key) {
  for (const nlohmann::json* values : {&run.labels, &run.parameters}) {
    if (values->is_object() && values->contains(key)) return values->at(key);
  }
  return nullptr;
}

bool sweeps_engine(const FigureRun& run) {
  return run.labels.is_object() && run.labels.contains("engine");
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

std::vector<std::string> varied_keys(std::span<const FigureRun> runs, std::string_view first) {
  std::set<nlohmann::json> variants;
  std::set<std::string> keys;
  for (const FigureRun& run : runs) {
    if (!run.labels.is_object()) continue;
    variants.insert(run.labels);
    for (const auto& [key, value] : run.labels.items()) keys.insert(key);
  }
  const std::vector<nlohmann::json> list(variants.begin(), variants.end());
  std::vector<std::string> in_order(keys.begin(), keys.end());
  std::stable_partition(in_order.begin(), in_order.end(),
                        [&](const std::string& key) { return key == first; });
  return keys_telling_apart(list, std::move(in_order));
}

std::span<const Figure> all_figures() {
  static const std::vector<Figure> all = {
      {"table1", "Table I beside the parameters of every experiment", figure_table1,
       FigureForm::table},
      of_groups("S1", "Volume fraction in the limit of hard grains", figure_s1, {"pressure_at"}),
      of_curves("S2", "Still fluid and fluid that moves with the cell", figure_s2, {"fluid"}),
      of_curves("S3", "Time steps", figure_s3, {"steps_per_cycle"}),
      of_curves("S4", "Moving bottom wall and moving top wall", figure_s4,
                {"moving_wall", "pressure_at"}),
      of_groups("S5a", "Onset of crystallization against amplitude", figure_s5a, {"amplitude_rad"}),
      of_groups("S5b", "Onset of crystallization against system size", figure_s5b, {"grains"}),
      of_curves("S6", "Shear with and without gravity", figure_s6,
                {"amplitude_rad", "gravity_m_per_s2"}),
      of_groups("S7", "Where crystallites nucleate", figure_s7,
                {"amplitude_rad", "stiffness_N_per_m"}, {"crystallites"}),
      of_groups("C", "Growth of crystallites by size", figure_c, {"amplitude_rad"},
                {"crystallites"}),
      of_groups("nucleation", "Runs without an onset, and the rate of nucleation",
                figure_nucleation, {"amplitude_rad", "grains"}),
      of_groups("nucleation_core", "The rate of nucleation at least 4 d from the walls",
                figure_nucleation_core, {"amplitude_rad", "grains"}, {"core"}),
      of_curves("B5", "Continuous and periodically paused shear", figure_b5, {"protocol"},
                {"at_rest"}),
      of_curves("walls", "Rough and smooth walls", figure_walls, {"walls"}),
      of_curves("choices", "Mass and drag of the moving wall, and other wall grains",
                figure_choices,
                {"wall_mass_grains_per_d2", "wall_drag_grains_per_d2_s", "wall_grain_draw"})};
  return all;
}

const Figure* find_figure(std::string_view name) {
  const auto all = all_figures();
  const auto found = std::ranges::find(all, name, &Figure::name);
  return found == all.end() ? nullptr : &*found;
}

}  // namespace shearcell
