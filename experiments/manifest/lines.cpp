// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/lines.hpp"

#include <algorithm>
#include <utility>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
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
  const auto found =
      std::ranges::find_if(map.entries, [&](const auto& entry) { return entry.first.text == key; });
  return found == map.entries.end() ? nullptr : &*found;
}

class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  void add(std::string key, const Position& at) {
    found_.push_back({std::move(key), at.line, text_of_line(text_, at.line)});
  }
  /// False if the map is null or has no such key.
  bool add_key(const std::pair<Node, Node>* map, const std::string& path, const std::string& key) {
    const auto* entry = map == nullptr ? nullptr : find(map->second, key);
    if (entry != nullptr) add(path + key, entry->first.at);
    return entry != nullptr;
  }
  void add_labels(const std::vector<SweepAxis>& axes, const std::string& path,
                  const nlohmann::json& labels) {
    for (const SweepAxis& axis : axes) {
      const auto label = labels.find(axis.key);
      if (label == labels.end()) continue;
      const auto value = std::ranges::find(axis.values, *label, &Setting::value);
      add(path + axis.key, value == axis.values.end() ? axis.at : value->at);
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
    const std::pair<Node, Node> document{{}, read_document(text, "manifest")};
    const Manifest manifest = parse_manifest(text, "manifest");
    const auto* scales = find(document.second, "scales");
    const auto* own = scales == nullptr ? nullptr : find(scales->second, scale);
    const std::string path = "scales." + std::string(scale);
    const auto stated = std::ranges::find(manifest.scales, scale, &Scale::name);
    const bool own_sweep = stated != manifest.scales.end() && stated->sweep;
    const Sweep& sweep = own_sweep ? *stated->sweep : *manifest.base.sweep;
    const std::string sweep_path = own_sweep ? path + ".sweep." : "sweep.";

    Lines lines(text);
    lines.add_key(&document, "", "experiment");
    if (own != nullptr) lines.add(path, own->first.at);
    lines.add_labels(sweep.grid, sweep_path + "grid.", labels);
    lines.add_labels(sweep.zip, sweep_path + "zip.", labels);
    if (!lines.add_key(own, path + ".", "cycles")) {
      lines.add_key(find(document.second, "base"), "base.", "cycles");
    }
    if (!lines.add_key(own, path + ".", "seeds")) lines.add_key(&document, "", "seeds");
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
    const Scale stated =
        scale == manifest.scales.end() ? manifest.base : whole_scale(manifest, *scale);
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
    const auto swept = [](const std::vector<SweepAxis>& axes) {
      return std::ranges::find(axes, "engine", &SweepAxis::key) != axes.end();
    };
    const auto engine = membership.labels.find("engine");
    if (engine != membership.labels.end() && !swept(stated.sweep->grid) &&
        !swept(stated.sweep->zip)) {
      found.push_back({"engine", *engine, value_at(stated, "engine")});
    }
  } catch (const ManifestError&) {
    found.clear();
  }
  return found;
}

}  // namespace shearcell
