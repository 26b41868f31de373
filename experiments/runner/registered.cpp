// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/registered.hpp"

#include <algorithm>

#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/variants.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

// Variants are grouped by experiment, SHA-256 of the manifest, and scale. In a group, different
// variants have different names. For packings, kPackings replaces the SHA-256, so that the packings
// of all versions of a manifest are in one group.
const std::string kPackings = "packings";

/// All registered manifests, oldest first. If an experiment returned to an earlier manifest, this
/// manifest appears twice. Throws StoreDamaged for an event that does not hold a manifest.
std::vector<RegisteredManifest> registered_manifests(const Store& store) {
  std::vector<RegisteredManifest> found;
  std::vector<Event> events = store.events("", "ManifestRegistered");
  // The log of a merged store is not in chronological order.
  std::ranges::stable_sort(events, {}, &Event::recorded_at);
  for (const Event& event : events) {
    auto registered = std::get<events::ManifestRegistered>(events::decode(event));
    RegisteredManifest& manifest = found.emplace_back();
    static_cast<ManifestText&>(manifest) = {std::move(registered), event.recorded_at};
    try {
      manifest.info.at("experiment").get_to(manifest.experiment);
      manifest.question = manifest.info.value("question", "");
      manifest.info.at("figures").get_to(manifest.figures);
    } catch (const nlohmann::json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  }
  return found;
}

VariantNames::Labels recorded_labels(const Store& store) {
  VariantNames::Labels labels;
  for (const RegisteredManifest& manifest : registered_manifests(store)) {
    labels[manifest.sha256] = recorded_manifest(manifest.text).labels;
  }
  return labels;
}

}  // namespace

std::pair<VariantNames::Group, nlohmann::json> VariantNames::key_of(const Stage& stage,
                                                                    const Place& place) {
  if (stage.kind == name_of(StageKind::prepare)) {
    return {{place.experiment, kPackings, place.scale}, effective_parameters(stage.resolved)};
  }
  return {{place.experiment, place.manifest, place.scale}, place.swept};
}

VariantNames::VariantNames(const Store& store)
    : VariantNames(store.stages(), recorded_labels(store)) {}

VariantNames::VariantNames(const std::vector<Stage>& stages, const Labels& labels) {
  std::map<Group, std::vector<nlohmann::json>> values;
  for (const Stage& stage : stages) {
    for (const Membership& m : stage.memberships) {
      auto [group, vary] = key_of(stage, m.place);
      values[group].push_back(std::move(vary));
    }
  }
  for (const auto& [group, vary] : values) {
    const auto stated = labels.find(std::get<1>(group));
    const auto names =
        variant_names(vary, stated == labels.end() ? std::vector<VariantLabel>() : stated->second);
    const bool of_packings = std::get<1>(group) == kPackings;
    if (of_packings && names.size() < 2) continue;  // a single packing has the name "packing"
    for (const auto& [value, name] : names) {
      names_[{group, value}] = of_packings ? "packing " + name : name;
    }
  }
}

std::string VariantNames::of(const Stage& stage, const Place& place) const {
  const auto name = names_.find(key_of(stage, place));
  return name == names_.end() ? place.variant : name->second;
}

std::vector<RegisteredManifest> newest_manifests(const Store& store) {
  nlohmann::ordered_map<std::string, RegisteredManifest> newest;  // by experiment
  for (RegisteredManifest& manifest : registered_manifests(store)) {
    newest[manifest.experiment] = std::move(manifest);
  }
  std::vector<RegisteredManifest> all;
  for (auto& [experiment, manifest] : newest) {
    manifest.content = recorded_manifest(manifest.text);
    all.push_back(std::move(manifest));
  }
  return all;
}

}  // namespace shearcell
