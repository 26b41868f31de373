// SPDX-License-Identifier: GPL-3.0-or-later
// The origin of a published figure: checkpoints, runs, manifests, builds and hosts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/manifest/lines.hpp"
#include "provenance/lineage.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// One run of the figure.
struct FigureInput {
  std::string run;
  std::string experiment;
  std::string variant;
  std::uint64_t seed = 0;
  std::string manifest;                  ///< SHA-256
  std::vector<ManifestLine> lines;       ///< of that manifest
  nlohmann::json overrides;              ///< key -> {"run", "manifest"}; null without any
  std::vector<std::string> checkpoints;  ///< SHA-256 of those that entered the figure
};

struct FigureLineage {
  FigureRecord record;
  std::vector<FigureInput> inputs;
  std::map<std::string, std::string> outputs;  ///< file name -> SHA-256
  std::vector<ManifestText> manifests;         ///< each once
  std::map<std::string, RunLineage> runs;      ///< of the inputs and of the stages before them
};

/// Values of the command line in place of the manifest's: {"cycles": {"run": 8, "manifest": 5}};
/// null without any.
nlohmann::json overrides_of(const Store& store, const RunRecord& run, const Membership& membership);
/// "S2" of a record that is called "drag/S2". Older records are called "S2".
std::string figure_name(const FigureRecord& record);

/// The text of a figure's lineage file, from the payload of its record.
std::string lineage_text(nlohmann::json provenance);

/// Every record of every figure, oldest first.
std::vector<FigureRecord> figure_records(const Store& store);

/// Collects it from the log. Throws StoreDamaged if the record is malformed or names a run that the
/// store does not have.
FigureLineage figure_lineage(const Store& store, const FigureRecord& record);

nlohmann::json to_json(const FigureLineage& lineage);

/// Whether a file on disk is one that a figure's record names.
struct PublishedFile {
  std::string sha256;    ///< of its bytes
  std::string recorded;  ///< what it should be
  FigureRecord record;

  bool matches() const { return sha256 == recorded; }
};

/// Finds the record by the SHA-256 of the file's bytes, else by the lineage file beside it, else by
/// its name. Nothing if the store never made such a file. Throws NotFound if there is no such
/// regular file.
std::optional<PublishedFile> find_published(const Store& store, const std::filesystem::path& file);

/// An input that cannot be read as it was.
struct InputFault {
  std::string run;
  std::string checkpoint;
  std::string what;  ///< "missing ...", "pruned", "the log does not have it"
};

/// Reads and hashes every input checkpoint.
std::vector<InputFault> check_inputs(const Store& store, const FigureLineage& lineage);

}  // namespace shearcell
