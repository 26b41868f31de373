// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/registered.hpp"

#include <algorithm>
#include <utility>

#include "experiments/manifest/variants.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
std::vector<RegisteredManifest> registered_manifests(const Store& store) {
  std::vector<RegisteredManifest> found;
  for (const Event& event : store.events("", "ManifestRegistered")) {
    try {
      const nlohmann::json body = event.body();
      const nlohmann::json& info = body.at("info");
      found.push_back({body.at("sha256").get<std::string>(),
                       info.at("experiment").get<std::string>(), info.value("question", ""),
                       info.at("figures").get<std::vector<std::string>>(),
                       body.at("text").get<std::string>()});
    } catch (const nlohmann::json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  }
  return found;
}

std::optional<Manifest> read(const RegisteredManifest& manifest) {
  try {
    return read_manifest(manifest.text, "manifest");
  } catch (const ManifestError&) {
    return std::nullopt;  // of another version of the schema
  }
}

VariantNames::Key VariantNames::key_of(const Membership& m) {
  return {m.experiment, m.manifest, m.scale, m.variant};
}

VariantNames::VariantNames(const Store& store)
    : VariantNames(registered_manifests(store), store.runs()) {}

VariantNames::VariantNames(const std::vector<RegisteredManifest>& manifests,
                           const std::vector<RunRecord>& runs) {
  std::map<std::string, std::vector<VariantLabel>> labels;
  for (const RegisteredManifest& manifest : manifests) {
    if (auto known = read(manifest)) labels[manifest.sha256] = std::move(known->labels);
  }
  using Group = std::map<std::string, nlohmann::json>;  // variant -> swept values
  std::map<std::tuple<std::string, std::string, std::string>, Group> groups;
  for (const RunRecord& run : runs) {
    if (run.kind == "prepare") continue;
    for (const Membership& m : run.memberships) {
      groups[{m.experiment, m.manifest, m.scale}][m.variant] = m.labels;
    }
  }
  for (const auto& [where, group] : groups) {
    std::vector<nlohmann::json> variants;
    for (const auto& [variant, values] : group) variants.push_back(values);
    const auto names = variant_names(variants, labels[std::get<1>(where)]);
    std::size_t at = 0;
    for (const auto& [variant, values] : group) {
      names_[std::tuple_cat(where, std::tuple(variant))] = names[at++];
    }
  }
}

std::string VariantNames::of(const Membership& membership) const {
  const auto found = names_.find(key_of(membership));
  return found == names_.end() ? membership.variant : found->second;
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
