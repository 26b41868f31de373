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

/// A registered manifest with what its info says: experiment, question and names of figures. The
/// text, for recorded_manifest(), may have another SHA-256 in a damaged store.
struct RegisteredManifest : ManifestText {
  std::string experiment;
  std::string question;
  std::vector<std::string> figures;
};

/// Display names of the variants of stages, by variant_names() of each manifest. A settled packing
/// is called "packing". If an experiment has packings that differ at one scale, the values that
/// differ follow: "packing N=600".
class VariantNames {
 public:
  using Labels = std::map<std::string, std::vector<VariantLabel>>;  ///< by SHA-256 of the manifest
  explicit VariantNames(const Store& store);
  VariantNames(const std::vector<Stage>& stages, const Labels& labels);
  /// The name of the stage in this place; if unknown, the variant.
  std::string of(const Stage& stage, const Place& place) const;

 private:
  using Group = std::tuple<std::string, std::string, std::string>;  // experiment, manifest, scale
  /// The runs among which the run is named, and the values that tell it apart from these.
  static std::pair<Group, nlohmann::json> key_of(const Stage& stage, const Place& place);

  std::map<Group, std::map<nlohmann::json, std::string>> names_;  // by values that vary
};

/// The version of each experiment that was registered last, in the order in which the experiments
/// were first registered. Throws StoreDamaged for an event that does not hold a manifest.
std::vector<RegisteredManifest> newest_manifests(const Store& store);

}  // namespace shearcell
