// SPDX-License-Identifier: GPL-3.0-or-later
// The manifests that are registered in a store, and display names of variants and packings.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "provenance/lineage.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// A registered manifest. `experiment`, `question` and `figures` (names of figures) are copies from
/// `info`; newest_manifests() sets `content`, the parsed `text`. In a damaged store, `sha256` may
/// differ from the SHA-256 of `text`.
struct RegisteredManifest : ManifestText {
  std::string experiment;
  std::string question;
  std::vector<std::string> figures;
  Manifest content = {};
};

/// Display names of the variants of each manifest (by variant_names()) and of settled packings. A
/// packing is called "packing". If the packings of an experiment at one scale have different
/// parameters, the name also states the parameters that differ: "packing N=600".
class VariantNames {
 public:
  using Labels = std::map<std::string, std::vector<VariantLabel>>;  ///< by SHA-256 of the manifest
  explicit VariantNames(const Store& store);
  VariantNames(const std::vector<Stage>& stages, const Labels& labels);
  /// Display name of the variant of `stage` at `place`; place.variant if no such name is known.
  std::string of(const Stage& stage, const Place& place) const;

 private:
  using Group = std::tuple<std::string, std::string, std::string>;  // experiment, manifest, scale
  /// The group in which names must be unique, and the values that determine the run's name.
  static std::pair<Group, nlohmann::json> key_of(const Stage& stage, const Place& place);

  std::map<std::pair<Group, nlohmann::json>, std::string> names_;  // keys: see key_of()
};

/// The last registered manifest of each experiment, in the order in which the experiments were
/// first registered. Throws StoreDamaged for an event that does not hold a manifest.
std::vector<RegisteredManifest> newest_manifests(const Store& store);

}  // namespace shearcell
