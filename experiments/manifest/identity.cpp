// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/identity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

// stage_key() hashes this text and the record of a stage. If the meaning of records changes, this
// text must change too, so that records with different meanings never have equal ids.
constexpr std::string_view kDomain = "shearcell stage 1\n";

json as_json(const Field& field, std::string_view text) {
  return std::get<json>(read_value(field, text, false));
}

json record_of(const StageInputs& stage) {
  Parameters parameters = stage.parameters;
  // A parameter without effect has one fixed value, so that equal runs have equal records.
  if (!depends_on_pressure_at(parameters)) parameters.pressure_at = PressureAt::moving_wall;
  json values = json::object();
  for (const Field& field : schema()) {
    json value = field.identity.recorded_as.empty() ? field.get(parameters)
                                                    : as_json(field, field.identity.recorded_as);
    if (enters(field.identity, stage.stage, parameters.protocol, value)) {
      values[std::string(field.name)] = std::move(value);
    }
  }
  json resolved = {
      {"stage", name_of(stage.stage)}, {"seed", stage.seed}, {"parameters", std::move(values)}};
  if (!stage.parent.empty()) resolved["parent"] = stage.parent;
  if (stage.file) {
    json& start =
        resolved["start"] = {{"file", stage.file->sha256}, {"settles", stage.file->settles}};
    if (stage.file->unit) start["unit"] = name_of(*stage.file->unit);
  }
  return resolved;
}

Stage new_stage(const StageInputs& stage) {
  Stage made;
  made.resolved = record_of(stage);
  made.id = stage_key(made.resolved);
  made.parent = stage.parent;
  made.kind = name_of(stage.stage);
  made.grains = stage.parameters.grains;
  return made;
}

UnreadableRecord damaged(std::string_view key, std::string_view problem) {
  return UnreadableRecord(fmt::format("record of a stage: {} {}", key, problem));
}

// Parameters that do not affect the stage keep their default. If the record lacks a parameter that
// affects the stage, the parameter has the value `omitted_at`, which is never written to records.
void read_parameters(const json& values, StageInputs& record) {
  if (!values.is_object()) throw damaged("parameters", "is not a JSON object");
  Parameters& p = record.parameters;
  for (const Field& field : schema()) {  // `protocol` precedes parameters that depend on it
    const auto found = values.find(field.name);
    const Identity& identity = field.identity;
    if (found == values.end()) {
      if (identity.omitted_at.empty() || !enters(identity, record.stage, p.protocol, nullptr))
        continue;
      field.set(p, as_json(field, identity.omitted_at));
    } else if (const auto wrong = check_value(field, *found)) {
      throw damaged(field.name, fmt::format("{}. {}", wrong->problem, wrong->remedy));
    } else if (identity.recorded_as.empty() || *found != as_json(field, identity.recorded_as)) {
      field.set(p, *found);
    }
  }
}

StartFile read_start(const json& start) {
  const json sha256 = member_of(start, "file"), settles = member_of(start, "settles");
  const json unit = member_of(start, "unit");
  StartFile file;
  if (sha256.is_string()) file.sha256 = sha256.get<std::string>();
  if (!is_sha256_hex(file.sha256)) throw damaged("file", "is not a SHA-256");
  if (!settles.is_boolean()) throw damaged("settles", "is not true or false");
  file.settles = settles.get<bool>();
  if (unit.is_string()) file.unit = value_of<LengthUnit>(unit.get<std::string>());
  return file;  // read_stage() reports unknown keys and values
}

}  // namespace

Stage prepare_stage(const Parameters& parameters, std::uint64_t seed,
                    const std::optional<StartFile>& file) {
  return new_stage({StageKind::prepare, "", seed, parameters, file});
}

Stage last_stage(const Parameters& parameters, std::uint64_t seed, const Stage& parent) {
  return new_stage({stage_after_settling(parameters.protocol), parent.id, seed, parameters});
}

std::string stage_key(const json& resolved) {
  return sha256_hex(std::string(kDomain) + canonical_json(resolved));
}

StageInputs read_stage(const json& resolved) {
  const json name = member_of(resolved, "stage"), parent = member_of(resolved, "parent");
  const json seed = member_of(resolved, "seed"), values = member_of(resolved, "parameters");
  const auto stage = value_of<StageKind>(name.is_string() ? name.get<std::string>() : "");
  if (!stage) throw damaged("stage", "is not one of prepare, shear, stiffen");
  if (!seed.is_number_unsigned()) throw damaged("seed", "is not a whole number >= 0");
  StageInputs record{*stage, "", seed.get<std::uint64_t>(), {}};
  if (record.stage == StageKind::stiffen) record.parameters.protocol = ProtocolKind::stiffen;
  if (record.stage != StageKind::prepare) {
    if (parent.is_string()) record.parent = parent.get<std::string>();
    if (!is_sha256_hex(record.parent)) throw damaged("parent", "is not a run's id");
  }
  if (record.stage == StageKind::prepare && resolved.contains("start")) {
    record.file = read_start(resolved.at("start"));
  }
  read_parameters(values, record);
  if (record.stage != StageKind::prepare &&
      stage_after_settling(record.parameters.protocol) != record.stage) {
    throw damaged("protocol",
                  "is not a protocol that shears");  // this program never writes such a record
  }
  json own = record_of(record);
  for (const Field& field : schema()) {
    const auto found = values.find(field.name);
    if (field.identity.recorded_as.empty() || found == values.end()) continue;
    own["parameters"][std::string(field.name)] = *found;  // older records may have another value
  }
  for (const json& change : json::diff(own, resolved)) {
    const std::string key = change.at("path").get<std::string>();
    throw damaged(key.substr(key.rfind('/') + 1, 64),
                  change.at("op") == "remove"
                      ? "is missing"
                      : "is unknown, or has no effect on a run of this kind");
  }
  return record;
}

json effective_parameters(const json& resolved) {
  json values = json::object();
  try {
    const StageInputs inputs = read_stage(resolved);
    const Parameters& parameters = inputs.parameters;
    for (const Field& field : schema()) {
      if (!enters(field.identity, inputs.stage, parameters.protocol, nullptr)) continue;
      values[std::string(field.name)] = field.get(parameters);
    }
    if (!depends_on_pressure_at(parameters)) values.erase("pressure_at");
  } catch (const UnreadableRecord&) {  // damaged
    values = member_of(resolved, "parameters");
    if (!values.is_object()) values = json::object();
  }
  for (const Field& field : schema()) {
    if (!field.identity.recorded_as.empty()) values.erase(std::string(field.name));
  }
  return values;
}

EngineKind engine_of(const json& resolved) {
  const bool lammps =
      member_of(member_of(resolved, "parameters"), "engine") == name_of(EngineKind::lammps);
  return lammps ? EngineKind::lammps : EngineKind::shearcell;
}

std::string canonical_json(const json& value) {
  if (value.is_structured()) {
    std::vector<std::string> items;
    for (const auto& [key, item] : value.items()) {  // keys of a std::map, sorted by bytes
      items.push_back((value.is_object() ? json(key).dump() + ':' : "") + canonical_json(item));
    }
    const std::string list = fmt::format("{}", fmt::join(items, ","));
    return value.is_object() ? '{' + list + '}' : '[' + list + ']';
  }
  if (!value.is_number_float()) return value.dump();
  const double number = value.get<double>();
  if (!std::isfinite(number)) throw std::invalid_argument("canonical JSON: not a finite number");
  std::array<char, 32> digits;
  return {digits.data(),
          std::to_chars(digits.data(), digits.data() + digits.size(), number + 0.0).ptr};
}

}  // namespace shearcell
