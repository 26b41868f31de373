// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/identity.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

// Must change if the meaning of a key changes, so that keys of different meanings never collide.
constexpr std::string_view kDomain = "shearcell stage 1\n";

// Gives a parameter without effect one fixed value, so that equal runs have equal records.
Parameters without_ineffective(Parameters parameters) {
  if (!depends_on_pressure_at(parameters)) parameters.pressure_at = PressureAt::moving_wall;
  return parameters;
}

json as_json(const Field& field, std::string_view text) {
  return std::get<json>(read_value(field, text, false));
}

Stage stage_of(StageKind stage, const Parameters& given, std::uint64_t seed,
               const std::string& parent) {
  const Parameters parameters = without_ineffective(given);
  json values = json::object();
  for (const Field& field : schema()) {
    json value = field.identity.recorded_as.empty() ? field.get(parameters)
                                                    : as_json(field, field.identity.recorded_as);
    if (enters(field.identity, stage, parameters.protocol, value)) {
      values[std::string(field.name)] = std::move(value);
    }
  }
  json resolved = {{"stage", name_of(stage)}, {"seed", seed}, {"parameters", std::move(values)}};
  if (!parent.empty()) resolved["parent"] = parent;
  Stage made;
  made.id = stage_key(resolved);
  made.parent = parent;
  made.kind = name_of(stage);
  made.resolved = std::move(resolved);
  made.grains = parameters.grains;
  return made;
}

void append_canonical(const json& value, std::string& text) {
  if (value.is_structured()) {
    const bool object = value.is_object();  // a std::map, sorted by bytes
    const char* separator = "";
    text += object ? '{' : '[';
    for (const auto& [key, item] : value.items()) {
      text += separator;
      if (object) text += json(key).dump() + ':';
      append_canonical(item, text);
      separator = ",";
    }
    text += object ? '}' : ']';
  } else if (value.is_number_float()) {
    const double number = value.get<double>();
    if (!std::isfinite(number)) throw std::invalid_argument("canonical JSON: not a finite number");
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number + 0.0).ptr;
    text.append(digits.data(), end);
  } else {
    text += value.dump();
  }
}

UnreadableRecord damaged(std::string_view key, std::string_view problem) {
  return UnreadableRecord(fmt::format("record of a stage: {} {}", key, problem));
}

const json& member(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) throw damaged(key, "is missing");
  return *found;
}

std::string text_member(const json& object, const char* key) {
  const json& value = member(object, key);
  if (!value.is_string()) throw damaged(key, "is not a text");
  return value.get<std::string>();
}

std::optional<ProtocolKind> protocol_in(const json& values) {
  const auto found = values.find("protocol");
  if (found == values.end() || !found->is_string()) return std::nullopt;
  return value_of<ProtocolKind>(found->get_ref<const std::string&>());
}

// A parameter that does not affect the stage keeps its default. One that affects it and is missing
// from the record has the value at which it is omitted.
Parameters read_parameters(StageKind stage, const json& values) {
  if (!values.is_object()) throw damaged("parameters", "is not a JSON object");
  const auto protocol = protocol_in(values);
  Parameters parameters;
  for (const Field& field : schema()) {
    const auto found = values.find(field.name);
    if (found != values.end() && enters(field.identity, stage, protocol, *found)) {
      if (const auto wrong = check_value(field, *found)) {
        throw damaged(field.name, fmt::format("{}. {}", wrong->problem, wrong->remedy));
      }
      const std::string_view constant = field.identity.recorded_as;
      const bool is_constant = !constant.empty() && *found == as_json(field, constant);
      field.set(parameters, is_constant ? field.get(Parameters{}) : *found);
    } else if (found == values.end() && enters(field.identity, stage, protocol, nullptr)) {
      if (field.identity.omitted_at.empty()) throw damaged(field.name, "is missing");
      field.set(parameters, as_json(field, field.identity.omitted_at));
    } else if (found != values.end()) {
      throw damaged(field.name, "does not belong there");
    }
  }
  for (const auto& [key, value] : values.items()) {
    if (find_field(key) == nullptr) throw damaged(key.substr(0, 64), "is unknown");
  }
  return parameters;
}

}  // namespace

Stage prepare_stage(const Parameters& parameters, std::uint64_t seed) {
  return stage_of(StageKind::prepare, parameters, seed, "");
}

Stage last_stage(const Parameters& parameters, std::uint64_t seed, const Stage& parent) {
  return stage_of(stage_after_settling(parameters.protocol), parameters, seed, parent.id);
}

std::string stage_key(const json& resolved) {
  return sha256_hex(std::string(kDomain) + canonical_json(resolved));
}

StageInputs read_stage(const json& resolved) {
  if (!resolved.is_object()) throw UnreadableRecord("record of a stage: not a JSON object");
  const std::string name = text_member(resolved, "stage");
  const std::optional<StageKind> stage = value_of<StageKind>(name);
  if (!stage) throw damaged("stage", "is not one of prepare, shear, stiffen");
  StageInputs record;
  record.stage = *stage;
  const bool prepares = record.stage == StageKind::prepare;
  if (!prepares) {
    record.parent = text_member(resolved, "parent");
    if (!is_sha256_hex(record.parent)) throw damaged("parent", "is not a run's id");
  }
  const json& seed = member(resolved, "seed");
  if (!seed.is_number_unsigned()) throw damaged("seed", "is not a whole number >= 0");
  record.seed = seed.get<std::uint64_t>();
  record.parameters = read_parameters(record.stage, member(resolved, "parameters"));
  if (record.parameters != without_ineffective(record.parameters)) {
    throw damaged("pressure_at", "has no effect on such a run, so it cannot be part of its record");
  }
  if (record.stage == StageKind::stiffen) record.parameters.protocol = ProtocolKind::stiffen;
  // This program never writes such a record.
  if (record.stage == StageKind::shear &&
      stage_after_settling(record.parameters.protocol) != StageKind::shear) {
    throw damaged("protocol", "is not one that shears");
  }
  for (const auto& [key, value] : resolved.items()) {
    const bool known =
        key == "stage" || key == "seed" || key == "parameters" || (key == "parent" && !prepares);
    if (!known) throw damaged(key.substr(0, 64), "is unknown");
  }
  return record;
}

json effective_parameters(const json& resolved) {
  json values = json::object();
  try {
    const auto [stage, parent, seed, parameters] = read_stage(resolved);
    for (const Field& field : schema()) {
      if (!enters(field.identity, stage, parameters.protocol, nullptr)) continue;
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
  const json::json_pointer engine("/parameters/engine");
  const bool lammps = resolved.is_object() && resolved.contains(engine) &&
                      resolved.at(engine) == name_of(EngineKind::lammps);
  return lammps ? EngineKind::lammps : EngineKind::shearcell;
}

std::string canonical_json(const json& value) {
  std::string text;
  append_canonical(value, text);
  return text;
}

}  // namespace shearcell
