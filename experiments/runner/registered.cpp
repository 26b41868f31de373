// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/registered.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/variants.hpp"
#include "provenance/events.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

std::vector<RegisteredManifest> registered_manifests(const Store& store) {
  std::vector<RegisteredManifest> found;
  std::vector<Event> events = store.events("", "ManifestRegistered");
  // Not in the order of the log, which a merge decides.
  std::ranges::stable_sort(events, {}, &Event::recorded_at);
  for (const Event& event : events) {
    auto [sha256, path, text, info] = std::get<events::ManifestRegistered>(events::decode(event));
    try {
      found.push_back({std::move(sha256), info.at("experiment").get<std::string>(),
                       info.value("question", ""),
                       info.at("figures").get<std::vector<std::string>>(), std::move(text)});
    } catch (const nlohmann::json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  }
  return found;
}

std::optional<Manifest> parsed(const RegisteredManifest& manifest) {
  try {
    return read_manifest(manifest.text, "manifest");
  } catch (const ManifestError&) {
    return std::nullopt;  // of another version of the schema
  }
}

void PackingNames::add(const Ask& place, const nlohmann::json& resolved) {
  std::vector<nlohmann::json>& known = parameters_[{place.experiment, place.scale}];
  nlohmann::json parameters = effective_parameters(resolved);
  if (std::ranges::find(known, parameters) == known.end()) known.push_back(std::move(parameters));
}

std::string PackingNames::of(const Ask& place, const nlohmann::json& resolved) const {
  const auto known = parameters_.find({place.experiment, place.scale});
  if (known == parameters_.end() || known->second.size() < 2) return "packing";
  const auto names = variant_names(known->second, {});
  const auto own = names.find(effective_parameters(resolved));
  return own == names.end() ? "packing" : fmt::format("packing {}", own->second);
}

VariantNames::VariantNames(const Store& store) {
  std::map<std::string, std::vector<VariantLabel>> labels;
  for (const RegisteredManifest& manifest : registered_manifests(store)) {
    if (auto known = parsed(manifest)) labels[manifest.sha256] = std::move(known->labels);
  }
  std::map<Group, std::vector<nlohmann::json>> variants;
  for (const Stage& run : store.stages()) {
    for (const Ask& m : run.asks) {
      if (run.kind == name_of(StageKind::prepare)) {
        packings_.add(m, run.resolved);
      } else {
        variants[{m.experiment, m.manifest, m.scale}].push_back(m.swept);
      }
    }
  }
  for (const auto& [group, swept] : variants) {
    names_[group] = variant_names(swept, labels[std::get<1>(group)]);
  }
}

std::string VariantNames::of(const Ask& m) const {
  const auto group = names_.find({m.experiment, m.manifest, m.scale});
  if (group == names_.end()) return m.variant;
  const auto name = group->second.find(m.swept);
  return name == group->second.end() ? m.variant : name->second;
}

std::string VariantNames::of(const Stage& run, const Ask& m) const {
  return run.kind == name_of(StageKind::prepare) ? packings_.of(m, run.resolved) : of(m);
}

std::vector<RegisteredManifest> newest_manifests(const Store& store) {
  std::vector<RegisteredManifest> newest;
  for (RegisteredManifest& manifest : registered_manifests(store)) {
    const auto known =
        std::ranges::find(newest, manifest.experiment, &RegisteredManifest::experiment);
    if (known == newest.end()) {
      newest.push_back(std::move(manifest));
    } else {
      *known = std::move(manifest);
    }
  }
  return newest;
}

}  // namespace shearcell
