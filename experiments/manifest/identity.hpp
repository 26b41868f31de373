// SPDX-License-Identifier: GPL-3.0-or-later
// The id of a run: the SHA-256 of all values that determine the bits of the run, and of no others.
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

/// The file that gives the initial grains of a packing. Without a file, they are placed at random.
struct StartFile {
  std::string sha256;                   ///< of the file's text; the store keeps the text
  std::optional<LengthUnit> unit = {};  ///< unit of lengths, if the manifest gives one
  bool settles = false;  ///< whether the grains of the file settle before they are used
};

/// The inputs of a stage, as read from its record (Stage::resolved). Numbers of cycles, and
/// parameters that do not affect the stage, have their default values. The protocol of a
/// stiffening stage is `stiffen`.
struct StageInputs {
  StageKind stage = StageKind::prepare;
  std::string parent;
  std::uint64_t seed = 0;
  Parameters parameters;
  std::optional<StartFile> file = {};  ///< set only if the packing is made from a file
};

/// The stage that makes the packing, from loose grains or from the grains of a file. The result has
/// no memberships; its id is stage_key(resolved). Equal ids mean equal trajectories.
Stage prepare_stage(const Parameters& parameters, std::uint64_t seed,
                    const std::optional<StartFile>& file = {});

/// The stage after `parent`: a stiffening if the protocol is `stiffen`, otherwise a shear.
Stage last_stage(const Parameters& parameters, std::uint64_t seed, const Stage& parent);

/// SHA-256 (hex) of a fixed prefix and the canonical form of `resolved`. To check a recorded run,
/// compute this key from the record and compare the key with the run's id.
std::string stage_key(const nlohmann::json& resolved);

/// Thrown if the record of a stage is damaged or was written by another version of the program. The
/// message names the entry of the record that cannot be read.
struct UnreadableRecord : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a record, which is not trusted. Throws UnreadableRecord if something is missing, unknown
/// or out of range. Does not compare stage_key(resolved) with the run's id.
StageInputs read_stage(const nlohmann::json& resolved);

/// The parameters that affect a stage, from its record `resolved`. A parameter that is not in the
/// record has the value Identity::omitted_at. Parameters with Identity::recorded_as are left out,
/// because their recorded value may differ from the value that the run used. If the record is
/// damaged, the result has only the parameters in the record.
nlohmann::json effective_parameters(const nlohmann::json& resolved);

/// The engine given in a record, even if other parts of the record are damaged.
EngineKind engine_of(const nlohmann::json& resolved);

/// JSON without whitespace. Keys are sorted by their bytes. Real numbers have the fewest digits
/// that read back to the same double. Equal values give equal texts. Throws std::invalid_argument
/// on NaN or infinity.
std::string canonical_json(const nlohmann::json& json);

}  // namespace shearcell
