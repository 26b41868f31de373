// SPDX-License-Identifier: GPL-3.0-or-later
// Exports a run with its history as an RO-Crate 1.1 (https://w3id.org/ro/crate/1.1) that follows
// Process Run Crate 0.5 (https://w3id.org/ro/wfrun/process/0.5).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "provenance/lineage.hpp"

namespace shearcell {

/// The content of a crate: a run, the stages before it, and their manifests.
struct CrateFacts {
  std::vector<RunLineage> stages;  ///< the first stage first, the run itself last
  std::vector<ManifestText> manifests;
  std::string licence = {};  ///< URI of the licence of the data, or ""
};

/// Collects the content of a crate. Throws NotFound for an unknown run.
CrateFacts crate_facts(const Store& store, const std::string& run);

inline constexpr const char* kCrateMetadata = "ro-crate-metadata.json";

/// The content of ro-crate-metadata.json. Equal logs give equal bytes.
nlohmann::json ro_crate_metadata(const CrateFacts& facts);

/// Writes the metadata, the manifests and every checkpoint that was neither rejected nor pruned.
/// Each checkpoint is verified. `folder` must be missing, empty, or an earlier export of the same
/// run, which is updated: files of checkpoints that are no longer kept are deleted. Returns the
/// files, relative to the folder. Throws UsageError for any other folder and
/// StoreDamaged for a damaged checkpoint. After an error the folder may be incomplete.
std::vector<std::string> write_ro_crate(const Store& store, const CrateFacts& facts,
                                        const std::filesystem::path& folder);

}  // namespace shearcell
