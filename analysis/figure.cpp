// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analysis/figures/figures.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

double RunValue::or_nan() const {
  return missing == Missing::nothing ? value : std::nan("");
}

RunValue measured(double value) {
  return {value, std::isfinite(value) ? Missing::nothing : Missing::undefined};
}

nlohmann::json parameter_of(const FigureRun& run, const std::string& key) {
  return member_of(run.place.swept.contains(key) ? run.place.swept : run.parameters, key.c_str());
}

bool has_parameters(const FigureRun& run, const nlohmann::json& where) {
  return std::ranges::all_of(where.items(), [&](const auto& stated) {
    const nlohmann::json value = parameter_of(run, stated.key()), &wanted = stated.value();
    if (!value.is_number() || !wanted.is_number()) return value == wanted;
    const auto number = wanted.get<double>();
    return std::abs(value.get<double>() - number) <= 1e-6 * std::abs(number);
  });
}

const std::string& packing_of(const FigureRun& run) {
  return run.packing.empty() ? run.stage.id : run.packing;
}

std::vector<double> over_packings(RunGroup runs, std::span<const double> values) {
  nlohmann::ordered_map<std::string, std::vector<double>> packings;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (std::isfinite(values[k])) packings[packing_of(*runs[k])].push_back(values[k]);
  }
  std::vector<double> means;
  for (const auto& [packing, found] : packings) means.push_back(over_runs(found).mean.value());
  return means;
}

double number_of(const FigureRun& run, const std::string& key) {
  const nlohmann::json value = parameter_of(run, key);
  return value.is_number() ? value.get<double>() : std::nan("");
}

std::vector<const FigureRun*> pointers(std::span<const FigureRun> runs) {
  std::vector<const FigureRun*> all;
  for (const FigureRun& run : runs) all.push_back(&run);
  return all;
}

std::map<double, std::vector<const FigureRun*>> runs_by(std::span<const FigureRun> runs,
                                                        const std::string& parameter) {
  std::map<double, std::vector<const FigureRun*>> groups;
  for (const FigureRun& run : runs) {
    const double value = number_of(run, parameter);
    if (std::isfinite(value)) groups[value].push_back(&run);
  }
  return groups;
}

double at_start(RunGroup runs, const std::string& measure) {
  std::vector<double> values;
  for (const FigureRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    values.push_back(run->checkpoints.front().measures.number(measure));
  }
  return over_runs(values).mean.value_or(std::nan(""));
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

std::string averaged_key(std::span<const FigureRun> runs, const std::vector<std::string>& keys) {
  std::map<std::vector<nlohmann::json>, nlohmann::json> curves;  // with its first variant
  for (const FigureRun& run : runs) {
    std::vector<nlohmann::json> curve;
    for (const std::string& key : keys) curve.push_back(parameter_of(run, key));
    const nlohmann::json& first =
        curves.try_emplace(std::move(curve), run.place.swept).first->second;
    for (const auto& [key, value] : run.place.swept.items()) {
      if (first.value(key, nlohmann::json()) != value) return key;
    }
  }
  return "";
}

void require_told_apart(const std::string& figure, std::span<const FigureRun> runs,
                        const std::vector<std::string>& keys, const std::string& remedy) {
  const std::string key = averaged_key(runs, keys);
  if (key.empty()) return;
  const std::string& experiment = runs.front().place.experiment;
  throw UsageError(
      fmt::format("figure {} would average over the values of {} that experiment {} sweeps; {}",
                  figure, key, experiment, remedy));
}

std::vector<std::string> varied_keys(std::span<const FigureRun> runs, std::string_view first) {
  std::set<nlohmann::json> variants;
  std::set<std::string> keys;
  for (const FigureRun& run : runs) {
    if (!run.place.swept.is_object()) continue;
    variants.insert(run.place.swept);
    for (const auto& [key, value] : run.place.swept.items()) keys.insert(key);
  }
  const std::vector<nlohmann::json> list(variants.begin(), variants.end());
  std::vector<std::string> in_order(keys.begin(), keys.end());
  std::stable_partition(in_order.begin(), in_order.end(),
                        [&](const std::string& key) { return key == first; });
  return keys_telling_apart(list, std::move(in_order));
}

std::span<const Figure> computed_figures() {
  using enum FigureForm;
  using Names = std::vector<std::string>;
  const auto one = [](const char* name, const char* title, auto* make, FigureForm form,
                      Names keys = {}, Names needs = {}) {
    return Figure{name, title, make, form, std::move(keys), std::move(needs)};
  };
  static const std::vector<Figure> all = {
      one("table1", "Table I beside the parameters of every experiment", figure_table1, table),
      one("S1", "Volume fraction in the limit of hard grains", figure_s1, groups, {"pressure_at"}),
      one("S5a", "Onset of crystallization against amplitude", figure_s5a, groups,
          {"amplitude_rad"}),
      one("S5b", "Onset of crystallization against system size", figure_s5b, groups, {"grains"}),
      one("S6", "Shear with and without gravity", figure_s6, curves,
          {"amplitude_rad", "gravity_m_per_s2"}),
      one("S7", "Where crystallites nucleate", figure_s7, groups,
          {"amplitude_rad", "stiffness_N_per_m"}, {"crystallites"}),
      one("C", "Growth of crystallites by size", figure_c, groups, {"amplitude_rad"},
          {"crystallites"}),
      one("committor", "The probability that a crystallite grows", figure_committor, groups,
          {"amplitude_rad", "start_seed", "start_cycle"}, {"crystallites"}),
      one("nucleation", "Runs without an onset, and the rate of nucleation", figure_nucleation,
          groups, {"amplitude_rad", "grains"}),
      one("nucleation_core", "The rate of nucleation at least 4 d from the walls",
          figure_nucleation_core, groups, {"amplitude_rad", "grains"}, {"core"}),
      {"summary", "Onset, critical size and crystalline grains in all experiments", nullptr,
       table}};
  return all;
}

}  // namespace shearcell
