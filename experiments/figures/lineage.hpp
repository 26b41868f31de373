// SPDX-License-Identifier: GPL-3.0-or-later
// The origin of a published figure: checkpoints, runs, manifests, builds and hosts.
#pragma once

#include <array>
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

/// Ascending cycles as ranges {first, last, every}: {{0, 120, 1}, {133.5, 133.5, 1}}.
using Cycles = std::vector<std::array<double, 3>>;

/// "0:120:1, 133.5:133.5:1".
std::string to_text(const Cycles& cycles);

/// States of a run, as a published lineage file lists them. Hashes of states do not depend on the
/// version of HDF5; hashes of files do.
struct States {
  Cycles cycles;           ///< of the states
  std::string state_hash;  ///< hash of the last state
  std::string sha256;      ///< SHA-256 of a text that has one state_hash on each line

  bool operator==(const States&) const = default;
};

/// Returns the states of these checkpoints. `checkpoints` must be sorted by step.
States states_of(const std::vector<CheckpointRecord>& checkpoints);

struct FigureInput {
  std::string run;
  std::string experiment;
  std::string variant;
  std::uint64_t seed = 0;
  std::string manifest;                  ///< SHA-256
  std::vector<ManifestLine> lines;       ///< lines of the manifest that apply to the run
  nlohmann::json overrides;              ///< as overrides_of() returns them
  States states;                         ///< as in the figure's record
  std::vector<std::string> checkpoints;  ///< SHA-256 of the files, from the log
  std::string fault;                     ///< how the log differs from `states`; "" if both agree
};

struct FigureLineage {
  FigureRecord record;
  std::string scale;
  std::string plots;  ///< note that the program, not the manifest, defines the plots; or ""
  std::vector<FigureInput> inputs;
  std::map<std::string, std::string> outputs;  ///< file name -> SHA-256
  std::vector<ManifestText> manifests;         ///< manifests of the inputs, each once
  RunLineages runs;                            ///< of the input runs and of their parent stages
};

/// Returns the values of the manifest that the command line replaced, or null. Example for a run of
/// 8 cycles whose manifest requests 5: {"cycles": {"run": 8, "manifest": 5}}.
nlohmann::json overrides_of(const Store& store, const Stage& stage, const Place& place,
                            const Ask& ask);
/// Returns "S2" for a record named "drag/desk/S2". Records of older stores are named "drag/S2" or
/// "S2".
std::string figure_name(const FigureRecord& record);

/// The path of the figure: "drag/desk/S2" for example, or "desk/table1" for a figure of all
/// experiments. The path is "drag/desk/S2" even if an older version of this program named the
/// record "drag/S2".
std::string figure_path(const FigureRecord& record);

/// The text of a figure's lineage file, which is the payload of the figure's record without host
/// and build.
std::string lineage_text(nlohmann::json provenance);

/// All records of all figures, from the oldest to the newest.
std::vector<FigureRecord> figure_records(const Store& store);

/// Collects the lineage from the log. Throws StoreDamaged if the record is malformed or names an
/// unknown run. Also reads older records, which list the SHA-256 of every checkpoint file instead
/// of a hash of the states.
FigureLineage figure_lineage(const Store& store, const FigureRecord& record);

nlohmann::json to_json(const RunLineage& stage);
nlohmann::json to_json(const FigureLineage& lineage);

/// A file on disk that is listed in the record of a figure.
struct PublishedFile {
  std::string sha256;    ///< SHA-256 of the file's bytes
  std::string recorded;  ///< SHA-256 in the record
  FigureRecord record;

  bool matches() const { return sha256 == recorded; }
};

/// Finds the record of the figure to which a file belongs: by the SHA-256 of the file's bytes, else
/// by the lineage file in the same folder, else by the file's name. Returns nothing if the store
/// has no such record. Throws NotFound if the path is not a readable regular file, or if the
/// file is larger than StoreLimits::published_bytes.
std::optional<PublishedFile> find_published(const Store& store, const std::filesystem::path& file);

/// Reads and hashes every input checkpoint. Returns a finding for each checkpoint or run that
/// differs from the record. The subject of a finding is the SHA-256 of the checkpoint, or "" for a
/// whole run. A pruned file is a finding of severity `note`.
std::vector<Finding> check_inputs(const Store& store, const FigureLineage& lineage);

}  // namespace shearcell
