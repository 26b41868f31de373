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

/// Rising cycles as ranges {first, last, every}: {{0, 120, 1}, {133.5, 133.5, 1}}.
using Cycles = std::vector<std::array<double, 3>>;

/// "0:120:1, 133.5:133.5:1".
std::string to_text(const Cycles& cycles);

/// States of a run, as a published lineage file names them. Unlike the hashes of files, the hashes
/// of states do not depend on the version of HDF5.
struct States {
  Cycles cycles;           ///< of the states
  std::string state_hash;  ///< of the last state
  std::string sha256;      ///< of the text with one line for each state: its state_hash

  bool operator==(const States&) const = default;
};

/// The states of checkpoints in the order of their steps.
States states_of(const std::vector<CheckpointRecord>& checkpoints);

/// A run of the figure.
struct FigureInput {
  std::string run;
  std::string experiment;
  std::string variant;
  std::uint64_t seed = 0;
  std::string manifest;                  ///< SHA-256
  std::vector<ManifestLine> lines;       ///< of that manifest
  nlohmann::json overrides;              ///< key -> {"run", "manifest"}; null without any
  States states;                         ///< as recorded
  std::vector<std::string> checkpoints;  ///< SHA-256 of the files, from the log
  std::string fault;                     ///< how the log differs from `states`; "" if it does not
};

struct FigureLineage {
  FigureRecord record;
  std::string experiment;  ///< "" for a figure of all experiments
  std::string scale;
  std::string plots;  ///< "drawn by the plots of ..." if its manifest states none of its plots
  std::vector<FigureInput> inputs;
  std::map<std::string, std::string> outputs;  ///< file name -> SHA-256
  std::vector<ManifestText> manifests;         ///< each once
  RunLineages runs;                            ///< of the inputs and of the stages before them
};

/// Values that the command line gave instead of values of the manifest, as {"cycles": {"run": 8,
/// "manifest": 5}}; null if there are none.
nlohmann::json overrides_of(const Store& store, const Stage& stage, const Place& place,
                            const Ask& ask);
/// "S2" for a record named "drag/desk/S2", or "drag/S2" or "S2" as in older stores.
std::string figure_name(const FigureRecord& record);

/// "drag/desk/S2" also where an older version named the record "drag/S2"; "desk/table1" for a
/// figure of all experiments.
std::string figure_path(const FigureRecord& record);

/// The text of a figure's lineage file: the payload of its record without host and build.
std::string lineage_text(nlohmann::json provenance);

/// Every record of every figure, oldest first.
std::vector<FigureRecord> figure_records(const Store& store);

/// Collects the lineage from the log. Throws StoreDamaged if the record is malformed or names an
/// unknown run. Records of earlier versions list the SHA-256 of every file in place of `states`.
FigureLineage figure_lineage(const Store& store, const FigureRecord& record);

nlohmann::json to_json(const FigureLineage& lineage);

/// A file on disk that a figure's record names.
struct PublishedFile {
  std::string sha256;    ///< of its bytes
  std::string recorded;  ///< SHA-256 in the record
  FigureRecord record;

  bool matches() const { return sha256 == recorded; }
};

/// Finds the record of a file by the SHA-256 of the bytes, else by the lineage file beside it, else
/// by its name. Nothing if the store has no such record. Throws NotFound if the path is not a
/// regular file.
std::optional<PublishedFile> find_published(const Store& store, const std::filesystem::path& file);

/// Reads and hashes every input checkpoint. Returns those that are not as recorded: the subject is
/// the SHA-256, or "" for the run as a whole. A pruned file is a note.
std::vector<Finding> check_inputs(const Store& store, const FigureLineage& lineage);

}  // namespace shearcell
