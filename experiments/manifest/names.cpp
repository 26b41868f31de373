// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <set>

#include "analysis/figure.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// Swept keys: those of the schema in its order, then others.
std::vector<std::string> keys_of(const std::vector<json>& variants) {
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

/// Four digits, if they distinguish the values.
std::string short_text(const json& value, const std::string& key,
                       const std::vector<json>& variants) {
  if (!value.is_number_float()) return value_text(value);
  std::set<std::string> brief;
  std::set<double> exact;
  for (const json& variant : variants) {
    const json other = variant.value(key, json());
    if (!other.is_number()) continue;
    exact.insert(other.get<double>());
    brief.insert(fmt::format("{:.4g}", other.get<double>()));
  }
  return brief.size() == exact.size() ? fmt::format("{:.4g}", value.get<double>())
                                      : value_text(value);
}

/// "A=0.05 rad", "fluid=cell".
std::string setting_text(const std::string& key, const json& variant,
                         const std::vector<json>& variants) {
  if (!variant.contains(key)) return "no " + key;
  const Field* field = find_field(key);
  const std::string value = short_text(variant.at(key), key, variants);
  if (field == nullptr || field->symbol.empty()) return key + "=" + value;
  return fmt::format("{}={}{}{}", field->symbol, value, field->unit == "1" ? "" : " ",
                     field->unit == "1" ? "" : field->unit);
}

std::string name_of_variant(const json& variant, const std::vector<json>& variants,
                            const std::vector<std::string>& keys,
                            const std::vector<const VariantLabel*>& labels) {
  std::set<std::string> named;
  std::vector<std::string> parts;
  for (const VariantLabel* label : labels) {
    if (!selects(*label, variant)) continue;
    bool free = true;
    for (const auto& [key, value] : label->where.items()) free = free && !named.contains(key);
    if (!free) continue;
    for (const auto& [key, value] : label->where.items()) named.insert(key);
    parts.push_back(label->name);
  }
  for (const std::string& key : keys) {
    if (!named.contains(key)) parts.push_back(setting_text(key, variant, variants));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

bool selects(const VariantLabel& label, const json& variant) {
  if (!variant.is_object() || label.where.empty()) return false;
  for (const auto& [key, value] : label.where.items()) {
    const auto found = variant.find(key);
    if (found == variant.end() || *found != value) return false;
  }
  return true;
}

std::vector<std::string> variant_names(const std::vector<json>& variants,
                                       std::span<const VariantLabel> labels) {
  const std::vector<std::string> all = keys_of(variants);
  std::vector<std::string> keys = keys_telling_apart(variants, all);
  if (keys.empty() && !all.empty()) keys = {all.front()};
  std::vector<const VariantLabel*> longest_first;
  for (const VariantLabel& label : labels) longest_first.push_back(&label);
  std::ranges::stable_sort(longest_first, std::greater{},
                           [](const VariantLabel* label) { return label->where.size(); });
  std::vector<std::string> names;
  for (const json& variant : variants) {
    std::string name = name_of_variant(variant, variants, keys, longest_first);
    names.push_back(name.empty() ? "base" : std::move(name));
  }
  return names;
}

}  // namespace shearcell
