// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <sstream>

#include "experiments/manifest/numerics.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {
namespace {

void apply(const std::string& key, const Setting& setting, Parameters& parameters) {
  set_value(*find_field(key), setting.value, parameters);
}

}  // namespace

bool is_auto(const Setting& setting) {
  return setting.value == "auto";
}

AtScale at_scale(const Manifest& manifest, const Scale* scale) {
  AtScale result{manifest.base, &manifest.sweep, &manifest.seeds, manifest.checkpoints,
                 manifest.until};
  if (scale == nullptr) return result;
  for (const auto& [key, setting] : scale->settings) result.settings[key] = setting;
  if (scale->sweep) result.sweep = &*scale->sweep;
  if (scale->seeds) result.seeds = &*scale->seeds;
  if (scale->until) result.until = *scale->until;
  if (scale->checkpoints) result.checkpoints = *scale->checkpoints;
  return result;
}

std::string Variant::name() const {
  if (swept.empty()) return "base";
  std::string text;
  for (const auto& [key, setting] : swept) {
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", key, value_text(setting->value));
  }
  return text;
}

nlohmann::json Variant::labels() const {
  nlohmann::json labels = nlohmann::json::object();
  for (const auto& [key, setting] : swept) labels[key] = setting->value;
  return labels;
}

bool has_values(const std::string& wanted, const std::string& variant) {
  const auto parts_of = [](const std::string& list) {
    std::set<std::string> parts;
    std::istringstream text(list);
    for (std::string part; std::getline(text, part, ',');) parts.insert(part);
    return parts;
  };
  return std::ranges::includes(parts_of(variant), parts_of(wanted));
}

std::uint64_t variant_count(const Sweep& sweep) {
  std::uint64_t count = sweep.zip.empty() ? 1 : sweep.zip.front().values.size();
  for (const SweepAxis& axis : sweep.grid) {
    const std::uint64_t size = axis.values.size();
    if (size != 0 && count > std::numeric_limits<std::uint64_t>::max() / size) {
      return std::numeric_limits<std::uint64_t>::max();
    }
    count *= size;
  }
  return count;
}

void for_each_variant(const AtScale& scale, const std::function<void(const Variant&)>& visit) {
  Parameters base;
  std::vector<std::string> autos;
  for (const auto& [key, setting] : scale.settings) {
    if (is_auto(setting)) {
      autos.push_back(key);
    } else {
      apply(key, setting, base);
    }
  }
  const std::vector<SweepAxis>& grid = scale.sweep->grid;
  const std::vector<SweepAxis>& zip = scale.sweep->zip;
  const std::uint64_t rows = zip.empty() ? 1 : zip.front().values.size();
  const std::uint64_t count = variant_count(*scale.sweep);
  for (std::uint64_t index = 0; index < count; ++index) {
    Variant variant;
    variant.parameters = base;
    // The number `index`, read with one digit for each axis.
    std::uint64_t rest = index / rows;
    std::vector<std::size_t> digit(grid.size());
    for (std::size_t axis = grid.size(); axis-- > 0;) {
      digit[axis] = rest % grid[axis].values.size();
      rest /= grid[axis].values.size();
    }
    for (std::size_t axis = 0; axis < grid.size(); ++axis) {
      variant.swept.emplace_back(grid[axis].key, &grid[axis].values[digit[axis]]);
    }
    for (const SweepAxis& axis : zip) {
      const Setting& setting = axis.values[index % rows];
      if (is_length(axis.key)) {
        apply(axis.key, setting, variant.parameters);
      } else {
        variant.swept.emplace_back(axis.key, &setting);
      }
    }
    for (const auto& [key, setting] : variant.swept) apply(key, *setting, variant.parameters);
    for (const std::string& key : autos) {
      const auto is_key = [&](const auto& entry) { return entry.first == key; };
      if (std::ranges::none_of(variant.swept, is_key)) resolve_auto(key, variant.parameters);
    }
    visit(variant);
  }
}

}  // namespace shearcell
