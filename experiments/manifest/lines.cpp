// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/lines.hpp"

#include <algorithm>
#include <utility>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
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
  text = text.substr(0, text.find('\n'));
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return printable(text.substr(first, text.find_last_not_of(" \t\r") - first + 1), kLongest);
}

const std::pair<Node, Node>* find(const Node& map, std::string_view key) {
  for (const auto& entry : map.entries) {
    if (entry.first.text == key) return &entry;
  }
  return nullptr;
}

class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  void add(std::string key, const Position& at) {
    found_.push_back({std::move(key), at.line, text_of_line(text_, at.line)});
  }
  void add_key(const Node& map, std::string_view key, const std::string& path) {
    if (const auto* entry = find(map, key)) add(path, entry->first.at);
  }
  void add_labels(const std::vector<SweepAxis>& axes, const std::string& path,
                  const nlohmann::json& labels) {
    for (const SweepAxis& axis : axes) {
      const auto label = labels.find(axis.key);
      if (label == labels.end()) continue;
      const auto value =
          std::find_if(axis.values.begin(), axis.values.end(),
                       [&](const Setting& setting) { return setting.value == *label; });
      add(path + "." + axis.key, value == axis.values.end() ? axis.at : value->at);
    }
  }
  std::vector<ManifestLine> take() { return std::move(found_); }

 private:
  std::string_view text_;
  std::vector<ManifestLine> found_;
};

}  // namespace

std::vector<ManifestLine> manifest_lines(std::string_view text, std::string_view scale,
                                         const nlohmann::json& labels) {
  try {
    const Node document = read_document(text, "manifest");
    const Manifest manifest = parse_manifest(text, "manifest");
    Lines lines(text);
    lines.add_key(document, "experiment", "experiment");
    const Node* scale_node = nullptr;
    const Node* cycles_node = nullptr;
    std::string cycles_path = "base";
    if (const auto* base = find(document, "base")) cycles_node = &base->second;
    const Sweep* sweep = &manifest.sweep;
    std::string sweep_path = "sweep", seeds_path = "seeds";
    if (const auto* scales = scale.empty() ? nullptr : find(document, "scales")) {
      const std::string path = "scales." + std::string(scale);
      if (const auto* entry = find(scales->second, scale)) {
        lines.add(path, entry->first.at);
        scale_node = &entry->second;
        if (find(*scale_node, "cycles") != nullptr) {
          cycles_node = scale_node;
          cycles_path = path;
        }
      }
      for (const Scale& known : manifest.scales) {
        if (known.name != scale || !known.sweep) continue;
        sweep = &*known.sweep;
        sweep_path = path + ".sweep";
      }
      if (scale_node != nullptr && find(*scale_node, "seeds") != nullptr) {
        seeds_path = path + ".seeds";
      } else {
        scale_node = nullptr;
      }
    }
    lines.add_labels(sweep->grid, sweep_path + ".grid", labels);
    lines.add_labels(sweep->zip, sweep_path + ".zip", labels);
    if (cycles_node != nullptr) lines.add_key(*cycles_node, "cycles", cycles_path + ".cycles");
    lines.add_key(scale_node != nullptr ? *scale_node : document, "seeds", seeds_path);
    return lines.take();
  } catch (const ManifestError&) {
    return {};  // written for another version of the schema
  }
}

std::vector<Override> overrides(std::string_view text, const Membership& membership) {
  std::vector<Override> found;
  try {
    const Manifest manifest = parse_manifest(text, "manifest");
    const auto scale = std::ranges::find(manifest.scales, membership.scale, &Scale::name);
    const AtScale stated = at_scale(manifest, scale == manifest.scales.end() ? nullptr : &*scale);
    const auto value = [&](const char* key) {
      const auto setting = stated.settings.find(key);
      return setting == stated.settings.end() ? get_value(*find_field(key), Parameters{})
                                              : setting->second.value;
    };
    const auto labelled = [&](const auto& swept) {
      const auto label = membership.labels.find(swept.first);
      return label != membership.labels.end() && *label == swept.second->value;
    };
    for_each_variant(stated, [&](const Variant& variant) {
      const std::uint64_t cycles = target_cycles(variant.parameters);
      if (found.empty() && cycles != membership.target_cycles &&
          std::ranges::all_of(variant.swept, labelled)) {
        found.push_back({"cycles", membership.target_cycles, cycles});
      }
    });
    const std::vector<std::uint64_t>& seeds = stated.seeds->values;
    if (std::ranges::find(seeds, membership.seed) == seeds.end()) {
      found.push_back({"seed", membership.seed, seeds});
    }
    const auto swept = [&](const std::vector<SweepAxis>& axes) {
      return std::ranges::find(axes, "engine", &SweepAxis::key) != axes.end();
    };
    const auto engine = membership.labels.find("engine");
    if (engine != membership.labels.end() && !swept(stated.sweep->grid) &&
        !swept(stated.sweep->zip)) {
      found.push_back({"engine", *engine, value("engine")});
    }
  } catch (const ManifestError&) {
    found.clear();
  }
  return found;
}

}  // namespace shearcell
