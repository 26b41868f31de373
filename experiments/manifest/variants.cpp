// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/variants.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "analysis/figure.hpp"
#include "core/named.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/io/read_number.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// The swept keys: parameters in the order of the schema, then other keys.
std::vector<std::string> swept_keys(const std::vector<json>& variants) {
  std::set<std::string> present;
  for (const json& variant : variants) {
    if (!variant.is_object()) continue;
    for (const auto& [key, value] : variant.items()) present.insert(key);
  }
  std::vector<std::string> keys;
  for (const Field& field : schema()) {
    if (present.erase(std::string(field.name)) > 0) keys.emplace_back(field.name);
  }
  keys.insert(keys.end(), present.begin(), present.end());
  return keys;
}

/// The keys whose different values stay different when they are rounded to four digits.
std::set<std::string> keys_in_brief(const std::vector<std::string>& keys,
                                    const std::vector<json>& variants) {
  std::set<std::string> found;
  for (const std::string& key : keys) {
    std::set<std::string> brief;
    std::set<double> exact;
    for (const json& variant : variants) {
      const json value = variant.value(key, json());
      if (!value.is_number()) continue;
      exact.insert(value.get<double>());
      brief.insert(fmt::format("{:.4g}", value.get<double>()));
    }
    if (brief.size() == exact.size()) found.insert(key);
  }
  return found;
}

/// Writes a setting as "A=0.05 rad" or "fluid=cell". Returns "" if the variant lacks the key.
std::string setting_text(const std::string& key, const json& variant, bool brief) {
  if (!variant.contains(key)) {  // --engine adds `engine` to some runs
    return key == "engine" ? "engine=shearcell" : "";
  }
  const Field* field = find_field(key);
  const json& value = variant.at(key);
  const std::string text = brief && value.is_number_float()
                               ? fmt::format("{:.4g}", value.get<double>())
                               : value_text(value);
  if (field == nullptr || field->symbol.empty()) return key + "=" + text;
  return fmt::format("{}={}", field->symbol, text) +
         (field->unit == "1" ? "" : fmt::format(" {}", field->unit));
}

std::string name_of_variant(const json& variant, const std::vector<std::string>& keys,
                            const std::set<std::string>& brief,
                            const std::vector<const VariantLabel*>& labels) {
  std::set<std::string> named;
  std::vector<std::string> parts;
  for (const VariantLabel* label : labels) {
    if (!selects(*label, variant)) continue;
    const auto is_named = [&](const auto& item) { return named.contains(item.key()); };
    if (std::ranges::any_of(label->where.items(), is_named)) continue;
    for (const auto& [key, value] : label->where.items()) named.insert(key);
    parts.push_back(label->name);
  }
  for (const std::string& key : keys) {
    if (named.contains(key)) continue;
    std::string text = setting_text(key, variant, brief.contains(key));
    if (!text.empty()) parts.push_back(std::move(text));
  }
  return parts.empty() ? "no sweep" : fmt::format("{}", fmt::join(parts, ", "));
}

using Parts = std::set<std::pair<std::string, json>>;

/// The parts of a list, sorted by key: "b=2,a=1.0" gives {"a", 1} and {"b", 2}. A part without `=`
/// has the value "".
Parts parts_of(const std::string& list) {
  Parts parts;
  std::istringstream text(list);
  for (std::string part; std::getline(text, part, ',');) {
    part = same_spelling(part);
    const std::size_t equal = std::min(part.find('='), part.size());
    const std::string value = part.substr(std::min(equal + 1, part.size()));
    const auto whole = read_number<std::uint64_t>(value);
    const auto number = read_number<double>(value);
    parts.emplace(part.substr(0, equal), whole    ? json(*whole)
                                         : number ? json(*number)
                                                  : json(value));
  }
  return parts;
}

/// Whether `parts` has all `wanted` parts. Values are compared with is_within().
bool has_all(const Parts& parts, const Parts& wanted) {
  return std::ranges::all_of(wanted, [&](const auto& want) {
    return std::ranges::any_of(parts, [&](const auto& part) {
      return part.first == want.first && is_within(part.second, want.second);
    });
  });
}

void apply(const Settings& settings, Parameters& parameters) {
  for (const auto& [key, setting] : settings) {
    if (setting.value != "auto") find_field(key)->set(parameters, setting.value);
  }
}

}  // namespace

std::string same_spelling(std::string_view part) {
  const std::size_t equal = part.find('=');
  if (equal == part.npos) return std::string(trimmed(part));
  std::string_view key = trimmed(part.substr(0, equal));
  std::string_view value = trimmed(part.substr(equal + 1));
  const auto field = std::ranges::find(schema(), key, &Field::symbol);
  if (!key.empty() && field != schema().end()) {
    key = field->name;
    const std::string_view unit = field->unit;
    if (unit != "1" && value.ends_with(unit)) value.remove_suffix(unit.size());
    value = trimmed(value);
  }
  return fmt::format("{}={}", key, value);
}

json value_at(const Scale& scale, std::string_view key) {
  const auto stated = scale.settings.find(key);
  return stated == scale.settings.end() ? find_field(key)->get(Parameters{}) : stated->second.value;
}

void Filter::add(const std::string& text) {
  Wanted& one = wanted_.emplace_back(Wanted{text, "", parts_of(text)});
  for (const auto& [key, value] : one.parts) {
    if (value != "") one.keys += key + ",";
  }
}

bool Filter::passes(const std::string& value, const std::string& name) {
  if (wanted_.empty()) return true;
  if (known_.insert(value).second) seen_.push_back(value);
  Parts parts = parts_of(value), of_name = parts_of(name);
  const bool same = has_all(parts, of_name);
  if (!same && known_.insert(name).second) seen_.push_back(name);
  parts.merge(of_name);
  std::map<std::string_view, bool> fits;  // by keys
  for (Wanted& one : wanted_) {
    const bool has = has_all(parts, one.parts);
    one.found |= has;
    fits[one.keys] |= has;
  }
  return std::ranges::all_of(fits, [](const auto& of_keys) { return of_keys.second; });
}

const std::string* Filter::unfound() const {
  const auto missing = std::ranges::find(wanted_, false, &Wanted::found);
  return missing == wanted_.end() ? nullptr : &missing->text;
}

const SweepAxis* find_axis(const Sweep& sweep, std::string_view key) {
  for (const auto* axes : {&sweep.grid, &sweep.zip}) {
    const auto found = std::ranges::find(*axes, key, &SweepAxis::key);
    if (found != axes->end()) return &*found;
  }
  return nullptr;
}

std::uint64_t variant_count(const Sweep& sweep) {
  std::uint64_t count = sweep.zip.empty() ? 1 : sweep.zip.front().values.size();
  for (const SweepAxis& axis : sweep.grid) {
    count = std::min(count * axis.values.size(), ManifestLimits::runs + 1);
  }
  return count;
}

std::vector<Variant> variants_of(const Scale& scale) {
  const std::vector<SweepAxis>& zip = scale.sweep.zip;
  const std::uint64_t rows = zip.empty() ? 1 : zip.front().values.size();
  std::vector<Variant> variants(variant_count(scale.sweep));
  for (std::uint64_t index = 0; index < variants.size(); ++index) {
    Variant& made = variants[index];
    apply(scale.start.settings, made.parameters);
    apply(scale.settings, made.parameters);
    const auto take = [&](const SweepAxis& axis, std::uint64_t place) {
      const json& value = axis.values[place].value;
      if (axis.key == "seeds") {
        made.seeds = value.get<std::uint64_t>();
      } else {
        find_field(axis.key)->set(made.parameters, value);
      }
      if (is_length(axis.key)) return;
      made.name +=
          fmt::format("{}{}={}", made.swept.empty() ? "" : ",", axis.key, value_text(value));
      made.swept[axis.key] = value;
    };
    // Number of consecutive grid points that differ only in `axis` and in the axes after it.
    std::uint64_t block = variants.size() / rows;
    for (const SweepAxis& axis : scale.sweep.grid) {
      const std::uint64_t place = index / rows % block;
      block /= axis.values.size();
      take(axis, place / block);
    }
    for (const SweepAxis& axis : zip) take(axis, index % rows);
    if (made.swept.empty()) made.name = "base";
    made.packing = made.parameters;
    apply(scale.settle, made.packing);
    for (const auto& [key, setting] : scale.settings) {
      if (setting.value != "auto" || made.swept.contains(key)) continue;
      resolve_auto(key, made.parameters);
      resolve_auto(key, made.packing);
    }
  }
  return variants;
}

bool has_values(const json& variant, const json& where) {
  return std::ranges::all_of(where.items(), [&](const auto& item) {
    return is_within(member_of(variant, item.key().c_str()), item.value());
  });
}

bool selects(const VariantLabel& label, const json& variant) {
  return !label.where.empty() && has_values(variant, label.where);
}

std::vector<json> swept_in(std::span<const Variant> variants) {
  std::vector<json> swept;
  for (const Variant& variant : variants) swept.push_back(variant.swept);
  return swept;
}

std::map<json, std::string> variant_names(const std::vector<json>& variants,
                                          std::span<const VariantLabel> labels) {
  std::vector<std::string> all = swept_keys(variants);
  const auto some = std::stable_partition(all.begin(), all.end(), [&](const std::string& key) {
    return std::ranges::all_of(variants, [&](const json& v) { return v.contains(key); });
  });
  // Only the first of several keys that vary together is kept. If a variant lacked this key, it
  // would get no name. Therefore the keys that exist in every variant are put first.
  std::vector<std::string> keys = keys_telling_apart(variants, {all.begin(), some});
  for (const std::string& key : keys_telling_apart(variants, all)) {
    if (std::find(some, all.end(), key) != all.end()) keys.push_back(key);
  }
  if (keys.empty() && !all.empty()) keys = {all.front()};
  std::vector<const VariantLabel*> longest_first;
  for (const VariantLabel& label : labels) longest_first.push_back(&label);
  std::ranges::stable_sort(longest_first, std::greater{},
                           [](const VariantLabel* label) { return label->where.size(); });
  const std::set<std::string> brief = keys_in_brief(keys, variants);
  std::map<json, std::string> names;
  for (const json& variant : variants) {
    const auto [place, first] = names.try_emplace(variant);
    if (first) place->second = name_of_variant(variant, keys, brief, longest_first);
  }
  return names;
}

}  // namespace shearcell
