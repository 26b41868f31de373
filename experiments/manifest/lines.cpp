// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/lines.hpp"

#include <algorithm>
#include <utility>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kLongest = 200;

std::string text_of_line(std::string_view text, int line) {
  for (int skip = 1; skip < line; ++skip) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return printable(trimmed(text.substr(0, text.find('\n'))), kLongest);
}

}  // namespace

std::vector<ManifestLine> manifest_lines(std::string_view text, std::string_view scale,
                                         const nlohmann::json& swept, std::string_view figure) {
  std::vector<ManifestLine> found;
  const auto add = [&](std::string key, const Position& at) {
    found.push_back({std::move(key), at.line, text_of_line(text, at.line)});
  };
  try {
    const Manifest manifest = parse_manifest(text, "manifest");
    const Scale* own = find_scale(manifest, scale);
    const std::string path = "scales." + std::string(scale);
    const Scale& sweeping = own != nullptr && own->sweep ? *own : manifest.base;
    const auto add_swept = [&](const std::vector<SweepAxis>& axes, const std::string& kind) {
      for (const SweepAxis& axis : axes) {
        const auto value = swept.find(axis.key);
        if (value == swept.end()) continue;
        const auto stated = std::ranges::find(axis.values, *value, &Setting::value);
        add((&sweeping == own ? path + ".sweep." : "sweep.") + kind + axis.key,
            stated == axis.values.end() ? axis.at : stated->at);
      }
    };
    const auto add_cycles = [&](const Scale& in, const std::string& prefix) {
      const auto cycles = in.settings.find("cycles");
      if (cycles != in.settings.end()) add(prefix + ".cycles", cycles->second.at);
      return cycles != in.settings.end();
    };

    add("experiment", manifest.experiment_at);
    if (own != nullptr) add(path, own->at);
    add_swept(sweeping.sweep->grid, "grid.");
    add_swept(sweeping.sweep->zip, "zip.");
    if (own == nullptr || !add_cycles(*own, path)) add_cycles(manifest.base, "base");
    const auto add_stated = [&](const std::string& key, auto Scale::*member) {
      if (own != nullptr && own->*member) {
        add(path + "." + key, (own->*member)->at);
      } else if (manifest.base.*member && (manifest.base.*member)->at.line > 0) {
        add(key, (manifest.base.*member)->at);
      }
    };
    add_stated("seeds", &Scale::seeds);
    add_stated("checkpoints", &Scale::checkpoints);
    add_stated("until", &Scale::until);
    for (const VariantLabel& label : manifest.labels) {
      if (selects(label, swept)) add("labels", label.at);
    }
    for (const auto& plot : manifest.plots) {
      if (plot.name == figure || plot.figure == figure) add("plots", plot.at);
    }
    for (const auto& claim : manifest.claims) {
      if (claim.name == figure || claim.figure == figure) add("claims", claim.at);
    }
  } catch (const ManifestError&) {
    found.clear();  // a manifest of another version of the schema
  }
  return found;
}

nlohmann::json overrides(std::string_view text, const Membership& membership) {
  nlohmann::json found;
  const auto add = [&](const char* key, const nlohmann::json& run, const nlohmann::json& stated) {
    found[key] = {{"run", run}, {"manifest", stated}};
  };
  try {
    const Manifest manifest = parse_manifest(text, "manifest");
    const Scale* scale = find_scale(manifest, membership.scale);
    const Scale stated = scale == nullptr ? manifest.base : whole_scale(manifest, *scale);
    const auto selected = [&](const auto& swept) {
      const auto value = membership.swept.find(swept.first);
      return value != membership.swept.end() && *value == swept.second->value;
    };
    for (const Variant& variant : variants_of(stated)) {
      const std::uint64_t cycles = target_cycles(variant.parameters);
      if (found.is_null() && cycles != membership.target_cycles &&
          std::ranges::all_of(variant.swept, selected)) {
        add("cycles", membership.target_cycles, cycles);
      }
    }
    const std::vector<std::uint64_t>& seeds = stated.seeds->values;
    if (std::ranges::find(seeds, membership.seed) == seeds.end()) {
      add("seed", membership.seed, seeds);
    }
    const auto engine = membership.swept.find("engine");
    if (engine != membership.swept.end() && find_axis(*stated.sweep, "engine") == nullptr) {
      add("engine", *engine, value_at(stated, "engine"));
    }
  } catch (const ManifestError&) {
    found = nullptr;
  }
  return found;
}

}  // namespace shearcell
