// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/frame.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>
#include <set>
#include <utility>

#include "analysis/statistics.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

double RunValue::or_nan() const {
  return missing == Missing::nothing ? value : std::nan("");
}

RunValue measured(double value) {
  return {value, std::isfinite(value) ? Missing::nothing : Missing::undefined};
}

nlohmann::json parameter_of(const FrameRun& run, const std::string& key) {
  if (key == "experiment") return run.place.experiment;
  return member_of(run.place.swept.contains(key) ? run.place.swept : run.parameters, key.c_str());
}

bool is_within(const nlohmann::json& value, const nlohmann::json& wanted) {
  if (wanted.is_array()) {
    return std::ranges::any_of(wanted, [&](const auto& one) { return is_within(value, one); });
  }
  const bool whole = value.is_number_integer() && wanted.is_number_integer();
  if (!value.is_number() || whole) return value == wanted;
  const bool range = wanted.is_object();
  if (!range && !wanted.is_number()) return false;
  const auto number = value.get<double>();
  const double low = range ? wanted.value("min", -infinite) : wanted.get<double>();
  const double high = range ? wanted.value("max", infinite) : low;
  constexpr double rounded = 1e-6;
  return number >= low - rounded * std::abs(low) && number <= high + rounded * std::abs(high);
}

bool has_parameters(const FrameRun& run, const nlohmann::json& where) {
  return std::ranges::all_of(where.items(), [&](const auto& stated) {
    return is_within(parameter_of(run, stated.key()), stated.value());
  });
}

std::vector<const FrameRun*> all_runs_with(const nlohmann::json& where,
                                           std::span<const FrameRun> runs) {
  std::vector<const FrameRun*> found;
  // For each stage id, the experiment of the first matching run.
  std::map<std::string_view, std::string_view> experiments;
  for (const FrameRun& run : runs) {
    if (!has_parameters(run, where)) continue;
    const std::string_view experiment = run.place.experiment;
    const auto [first, fresh] = experiments.try_emplace(run.stage.id, experiment);
    if (fresh || first->second == experiment) found.push_back(&run);
  }
  return found;
}

std::vector<const FrameRun*> runs_with(const nlohmann::json& where,
                                       std::span<const FrameRun> runs) {
  const std::vector<const FrameRun*> found = all_runs_with(where, runs);
  std::vector<const FrameRun*> as_stated = found;
  std::erase_if(as_stated, [](const FrameRun* run) { return run->place.swept.contains("engine"); });
  return count_variants(found) > 1 && count_variants(as_stated) == 1 ? as_stated : found;
}

std::string shared_name(RunGroup runs) {
  return count_variants(runs) == 1 ? runs.front()->name : "";
}

std::set<std::string_view> stage_ids(RunGroup runs) {
  std::set<std::string_view> ids;
  for (const FrameRun* run : runs) ids.insert(run->stage.id);
  return ids;
}

const std::string& packing_of(const FrameRun& run) {
  return run.packing.empty() ? run.stage.id : run.packing;
}

PackingMeans means_by_packing(RunGroup runs, std::span<const CensoredValue> values) {
  nlohmann::ordered_map<std::string, std::vector<double>> packings;
  PackingMeans means;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!std::isfinite(values[k].value)) continue;
    const std::string& packing = packing_of(*runs[k]);
    packings[packing].push_back(values[k].value);
    means[packing].censored |= values[k].censored;
  }
  for (auto& [packing, mean] : means) mean.value = over_runs(packings.at(packing)).mean.value();
  return means;
}

std::vector<CensoredValue> values_of(const PackingMeans& means) {
  std::vector<CensoredValue> values;
  for (const auto& [packing, mean] : means) values.push_back(mean);
  return values;
}

std::vector<CensoredValue> over_packings(RunGroup runs, std::span<const CensoredValue> values) {
  return values_of(means_by_packing(runs, values));
}

double number_of(const FrameRun& run, const std::string& key) {
  const nlohmann::json value = parameter_of(run, key);
  return value.is_number() ? value.get<double>() : std::nan("");
}

std::vector<const FrameRun*> pointers(std::span<const FrameRun> runs) {
  std::vector<const FrameRun*> all;
  for (const FrameRun& run : runs) all.push_back(&run);
  return all;
}

std::map<double, std::vector<const FrameRun*>> runs_by(std::span<const FrameRun> runs,
                                                       const std::string& parameter) {
  std::map<double, std::vector<const FrameRun*>> groups;
  for (const FrameRun& run : runs) {
    const double value = number_of(run, parameter);
    if (std::isfinite(value)) groups[value].push_back(&run);
  }
  return groups;
}

double at_start(RunGroup runs, const std::string& measure) {
  std::vector<double> values;
  for (const FrameRun* run : runs) {
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

std::string averaged_key(RunGroup runs, const std::vector<std::string>& keys) {
  std::map<std::vector<nlohmann::json>, nlohmann::json> curves;  // first variant of each curve
  for (const FrameRun* run : runs) {
    std::vector<nlohmann::json> curve;
    for (const std::string& key : keys) curve.push_back(parameter_of(*run, key));
    const nlohmann::json& first =
        curves.try_emplace(std::move(curve), run->place.swept).first->second;
    for (const auto& [key, value] : run->place.swept.items()) {
      if (first.value(key, nlohmann::json()) != value) return key;
    }
  }
  return "";
}

void require_told_apart(const std::string& figure, RunGroup runs, const std::string& averaged,
                        const std::string& remedy) {
  if (averaged.empty()) return;
  throw UsageError(
      fmt::format("figure {} would average over the values of {} that experiment {} sweeps; {}",
                  figure, averaged, runs.front()->place.experiment, remedy));
}

std::vector<std::string> varied_keys(std::span<const nlohmann::json> variants,
                                     std::string_view first) {
  std::set<nlohmann::json> distinct;
  std::set<std::string> keys;
  for (const nlohmann::json& variant : variants) {
    if (!variant.is_object()) continue;
    distinct.insert(variant);
    for (const auto& [key, value] : variant.items()) keys.insert(key);
  }
  const std::vector<nlohmann::json> list(distinct.begin(), distinct.end());
  std::vector<std::string> in_order(keys.begin(), keys.end());
  std::stable_partition(in_order.begin(), in_order.end(),
                        [&](const std::string& key) { return key == first; });
  return keys_telling_apart(list, std::move(in_order));
}

std::vector<nlohmann::json> swept_of(RunGroup runs) {
  std::vector<nlohmann::json> swept;
  for (const FrameRun* run : runs) swept.push_back(run->place.swept);
  return swept;
}

PackingGroups by_packing(RunGroup group) {
  PackingGroups packings;
  for (const FrameRun* run : group) packings[packing_of(*run)].push_back(run);
  return packings;
}

std::string words_of(const nlohmann::json& values) {
  std::string text;
  for (const auto& [key, value] : values.items()) {
    text += (text.empty() ? "" : ", ") + key;
    const bool min = value.is_object() && value.contains("min");
    const bool max = value.is_object() && value.contains("max");
    if (min) text += (max ? " " : " >= ") + value_text(value["min"]);
    if (max) text += (min ? " to " : " <= ") + value_text(value["max"]);
    if (min || max) continue;
    const nlohmann::json any = value.is_array() ? value : nlohmann::json::array({value});
    text += fmt::format("={}", fmt::join(any | std::views::transform(value_text), " or "));
  }
  return text;
}

namespace {

/// The value of a measure of the run or of a parameter.
RunValue value_of(const FrameRun& run, const std::string& name) {
  const Measure* measure = find_measure(name, MeasureKind::run);
  return measure != nullptr ? measure->of_run(run) : measured(number_of(run, name));
}

}  // namespace

NumberColumn::NumberColumn(std::string text) : text_(std::move(text)) {
  if (!is_expression(text_)) return;
  names_ = names_in(text_);
  evaluate_ = evaluator_of(text_);
}

double NumberColumn::operator()(const FrameRun& run, const CheckpointMeasures* checkpoint) const {
  if (checkpoint == nullptr) return of_run(run).or_nan();
  const auto number = [&](const std::string& name) {
    if (find_measure(name) != nullptr) return checkpoint->measures.number(name);
    return name == "cycle" ? checkpoint->cycle : value_of(run, name).or_nan();
  };
  return evaluate_ ? evaluate_(number) : number(text_);
}

RunValue NumberColumn::of_run(const FrameRun& run) const {
  if (!evaluate_) return value_of(run, text_);
  std::map<std::string, double> numbers;
  double* bound = nullptr;  // of the censored measure
  std::size_t censored = 0;
  for (const std::string& name : names_) {
    const RunValue value = value_of(run, name);
    const bool ends_before = value.missing == Missing::too_short;
    if (value.missing != Missing::nothing && !ends_before) return {0, value.missing};
    double& number = numbers[name] = ends_before ? value.above : value.value;
    if (ends_before) ++censored, bound = &number;
  }
  const auto evaluate = [&] {
    return evaluate_([&](const std::string& name) { return numbers.at(name); });
  };
  const double first = evaluate();
  if (censored == 0) return measured(first);
  // The expression library only evaluates. Therefore "increases" means: does not decrease from one
  // point to the next, at 480 points from the bound to 1e6 times the bound (from 1 if it is 0).
  const double from = *bound, unit = from == 0 ? 1 : std::abs(from);
  double last = first;
  bool increases = censored == 1;
  for (int k = -240; k < 240 && increases; ++k) {
    *bound = from + unit * std::pow(10, k / 40.0);
    const double next = evaluate();
    increases = next >= last;
    last = next;
  }
  if (!increases) return {0, Missing::unbounded};
  // If the expression is constant above the bound, its value is known.
  return last > first ? RunValue{0, Missing::too_short, first} : measured(first);
}

std::string reach_of(std::string_view column) {
  std::set<std::string_view> reaches;
  for (const std::string& name : names_in(column)) {
    const Measure* measure = find_measure(name, MeasureKind::run);
    if (measure != nullptr) reaches.insert(measure->reach);
  }
  return reaches.empty() ? std::string(column) : fmt::format("{}", fmt::join(reaches, " and "));
}

std::vector<std::string> providers_of(std::span<const std::string> columns) {
  std::vector<std::string> names;
  for (const std::string& column : columns) {
    for (const std::string& name : names_in(column)) {
      for (const auto kind : {MeasureKind::number, MeasureKind::run, MeasureKind::curve}) {
        if (const Measure* one = find_measure(name, kind)) names.push_back(provider_of(*one).name);
      }
    }
  }
  return names;
}

const CheckpointMeasures* checkpoint_at(const FrameRun& run, double cycle) {
  const auto found = std::ranges::find(run.checkpoints, cycle, &CheckpointMeasures::cycle);
  return found == run.checkpoints.end() ? nullptr : &*found;
}

bool is_of_run(std::string_view column) {
  return std::ranges::none_of(names_in(column), [](const std::string& name) {
    return name == "cycle" || find_measure(name) != nullptr ||
           find_measure(name, MeasureKind::curve) != nullptr;
  });
}

bool is_measured_of_run(std::string_view column) {
  return std::ranges::any_of(names_in(column), [](const std::string& name) {
    return find_measure(name, MeasureKind::run) != nullptr;
  });
}

std::size_t count_variants(RunGroup runs) {
  std::set<std::string> distinct;
  for (const FrameRun* run : runs) distinct.insert(run->place.variant);
  return distinct.size();
}

}  // namespace shearcell
