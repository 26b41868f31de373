// SPDX-License-Identifier: GPL-3.0-or-later
// The id of a run: the SHA-256 of the values that decide its bits, and of nothing else.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "experiments/manifest/packing_file.hpp"
#include "experiments/manifest/parameters.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// The file of grains that a packing begins with, instead of loose grains.
struct StartFile {
  std::string sha256;                   ///< of the text, which the store keeps
  std::optional<LengthUnit> unit = {};  ///< of lengths, if the manifest states it
  bool settles = false;                 ///< whether the grains settle further
};

/// A stage, as read from its `resolved` record. Lengths, and parameters that do not affect the
/// stage, have their defaults; the protocol of a stiffening is `stiffen`.
struct StageInputs {
  StageKind stage = StageKind::prepare;
  std::string parent;
  std::uint64_t seed = 0;
  Parameters parameters;
  std::optional<StartFile> file = {};  ///< of a packing
};

/// The preparation: fill the cell, or place the grains of the file, and settle. The result has no
/// asks; its id is the hash of `resolved`. Equal ids mean equal trajectories.
Stage prepare_stage(const Parameters& parameters, std::uint64_t seed,
                    const std::optional<StartFile>& file = {});

/// The shear or, by the protocol, the stiffening that begins with the last state of `parent`.
Stage last_stage(const Parameters& parameters, std::uint64_t seed, const Stage& parent);

/// SHA-256 (hex) of a domain tag and the canonical form of `resolved`. A reader recomputes it to
/// check a recorded run against its id.
std::string stage_key(const nlohmann::json& resolved);

/// The record of a stage is damaged, or another version of the program wrote it. The message names
/// the key.
struct UnreadableRecord : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The record is not trusted: throws UnreadableRecord when something is missing, unknown or out of
/// range. Compare stage_key(resolved) with the run's id as well.
StageInputs read_stage(const nlohmann::json& resolved);

/// The parameters that affect the stage: the parameters that the record states, and the parameters
/// that it omits because they have the value of all older runs. Constants of the record
/// (Identity::recorded_as) are left out, since the run may have had other values. If the record is
/// damaged, the result is the parameters that it states.
nlohmann::json effective_parameters(const nlohmann::json& resolved);

/// The engine that a record names, even if other parts of the record are damaged.
EngineKind engine_of(const nlohmann::json& resolved);

/// JSON without whitespace, keys sorted by their bytes, doubles as the shortest digits that read
/// back to the same value: one text for one value. Throws std::invalid_argument on NaN or infinity.
std::string canonical_json(const nlohmann::json& json);

}  // namespace shearcell
