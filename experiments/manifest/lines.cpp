// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {
namespace {

std::string text_of_line(std::string_view text, int line) {
  constexpr std::size_t longest = 200;
  while (--line > 0) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return printable(trimmed(text.substr(0, text.find('\n'))), longest);
}

// The scale of this name; the top level of the manifest if no scale has this name.
const Scale& scale_of(const Manifest& manifest, std::string_view name) {
  const Scale* found = find_named(manifest.scales, name);
  return found == nullptr ? manifest.base : *found;
}

}  // namespace

std::vector<ManifestLine> manifest_lines(std::string_view text, std::string_view scale,
                                         const nlohmann::json& swept, std::string_view figure) {
  const Manifest manifest = recorded_manifest(text);
  if (manifest.experiment.empty()) return {};
  std::vector<ManifestLine> found;
  const auto add = [&](std::string key, const Position& at) {
    found.push_back({std::move(key), at.line, text_of_line(text, at.line)});
  };
  const Scale& stated = scale_of(manifest, scale);
  const auto path_of = [&](const std::string& key) {
    return stated.own.contains(key) ? fmt::format("scales.{}.{}", stated.name, key) : key;
  };
  add("experiment", manifest.experiment_at);
  if (!stated.name.empty()) add("scales." + stated.name, stated.at);
  for (const auto& [kind, axes] :
       {std::pair(".grid.", &stated.sweep.grid), {".zip.", &stated.sweep.zip}}) {
    for (const SweepAxis& axis : *axes) {
      const auto value = swept.find(axis.key);
      if (value == swept.end()) continue;
      const auto place = std::ranges::find(axis.values, *value, &Setting::value);
      add(path_of("sweep") + kind + axis.key, place == axis.values.end() ? axis.at : place->at);
    }
  }
  if (const auto cycles = stated.settings.find("cycles"); cycles != stated.settings.end()) {
    add(stated.own.contains("cycles") ? path_of("cycles") : "base.cycles", cycles->second.at);
  }
  for (const auto& [key, setting] : stated.settle) add(path_of("settle") + "." + key, setting.at);
  for (const auto& [key, at] : {std::pair("seeds", stated.seeds.at),
                                {"checkpoints", stated.checkpoints.at},
                                {"until", stated.until.at}}) {
    if (at.line > 0) add(path_of(key), at);
  }
  for (const VariantLabel& label : manifest.labels) {
    if (selects(label, swept)) add("labels", label.at);
  }
  const auto add_figure = [&](const char* key, const auto& own_figures) {
    for (const auto& one : own_figures) {
      if (figure_of(one) == figure) add(key, one.at);
    }
  };
  add_figure("plots", manifest.plots);
  add_figure("claims", manifest.claims);
  return found;
}

nlohmann::json overrides(std::string_view text, const Place& place, const Ask& ask) try {
  const Manifest manifest = parse_manifest(text, "manifest");
  nlohmann::json found;
  const auto add = [&](const char* key, const nlohmann::json& run, const nlohmann::json& stated) {
    found[key] = {{"run", run}, {"manifest", stated}};
  };
  const Scale& stated = scale_of(manifest, place.scale);
  for (const Variant& variant : variants_of(stated)) {
    const std::uint64_t cycles = target_cycles(variant.parameters);
    const bool is_it = has_values(place.swept, variant.swept);
    if (cycles == ask.target_cycles || !is_it) continue;
    add("cycles", ask.target_cycles, cycles);
    break;
  }
  const std::vector<std::uint64_t>& seeds = stated.seeds.values;
  if (std::ranges::count(seeds, place.seed) == 0) add("seed", place.seed, seeds);
  const auto engine = place.swept.find("engine");
  if (engine != place.swept.end() && find_axis(stated.sweep, "engine") == nullptr) {
    add("engine", *engine, value_at(stated, "engine"));
  }
  return found;
} catch (const ManifestError&) {
  return nullptr;
}

}  // namespace shearcell
