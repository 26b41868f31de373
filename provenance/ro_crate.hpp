// SPDX-License-Identifier: GPL-3.0-or-later
// One run with all that it came from as an RO-Crate 1.1 (https://w3id.org/ro/crate/1.1) that
// follows Process Run Crate 0.5 (https://w3id.org/ro/wfrun/process/0.5), with the same facts as
// PROV-JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "provenance/lineage.hpp"

namespace shearcell {

/// What a crate tells: a run, the stages before it, and the manifests that asked for them.
struct CrateFacts {
  std::vector<RunLineage> stages;  ///< the first stage first, the run itself last
  std::vector<ManifestText> manifests;
  std::string licence;  ///< URI of the licence of the data; "" when none was chosen
};

/// Reads it from the log. Throws NotFound for an unknown run.
CrateFacts crate_facts(const Store& store, const std::string& run, std::string licence = "");

/// Where things lie in the crate. Made of hashes alone, so nothing recorded can lead out of it.
std::string crate_path_of_checkpoint(const std::string& sha256);
std::string crate_path_of_manifest(const std::string& sha256);
inline constexpr const char* kCrateMetadata = "ro-crate-metadata.json";
inline constexpr const char* kCrateProv = "prov.json";

/// The content of ro-crate-metadata.json. `prov` is the content of prov.json. Nothing depends on
/// the clock or on this machine: equal logs give equal bytes.
nlohmann::json ro_crate_metadata(const CrateFacts& facts, const std::string& prov);

/// Identifier of the crate of a run; tells a folder that was exported before from any other.
std::string crate_identifier(const std::string& run);

/// Writes the crate: metadata, prov.json, the manifests and every checkpoint that was neither
/// rejected nor pruned, each verified while it is copied. `folder` must be missing, empty, or an
/// earlier export of the same run, which is brought up to date. A new folder appears whole or not
/// at all. Returns the files in it, relative to the folder. Throws std::invalid_argument when the
/// folder is something else, StoreDamaged when a checkpoint is.
std::vector<std::string> write_ro_crate(const Store& store, const std::string& run,
                                        const std::filesystem::path& folder,
                                        const std::string& licence = "");

}  // namespace shearcell
