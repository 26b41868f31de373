// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/identity.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

// Changes with the meaning of a key, so that keys of different meanings never meet.
constexpr std::string_view kDomain = "shearcell stage 1\n";

bool is_default(const Field& field, const json& value) {
  return value == get_value(field, Parameters{});
}

// Whether the record of a stage holds the parameter with that value. A sheared cell feels what it
// settled under as well.
bool enters(const Field& field, Stage stage, std::string_view protocol, const json& value) {
  switch (field.identity) {
    case Identity::prepare:
      return true;
    case Identity::prepare_if_set:
      return !is_default(field, value);
    case Identity::shear_if_set:
      return stage == Stage::shear && !is_default(field, value);
    case Identity::shear:
      return stage == Stage::shear;
    case Identity::paused_shear:
      return stage == Stage::shear && protocol == "paused";
    case Identity::stiffen:
      return stage == Stage::stiffen;
    case Identity::none:
      break;
  }
  return false;
}

// One value for all that make the same run.
Parameters without_what_is_not_felt(Parameters parameters) {
  if (!feels_pressure_at(parameters)) parameters.pressure_at = PressureAt::moving_wall;
  return parameters;
}

json resolve(Stage stage, const Parameters& given, std::uint64_t seed) {
  const Parameters parameters = without_what_is_not_felt(given);
  json values = json::object();
  for (const Field& field : schema()) {
    json value = get_value(field, parameters);
    if (enters(field, stage, parameters.protocol, value))
      values[std::string(field.name)] = std::move(value);
  }
  return {{"stage", stage_name(stage)}, {"seed", seed}, {"parameters", std::move(values)}};
}

void append_canonical(const json& value, std::string& text) {
  if (value.is_object()) {
    char separator = '{';
    for (const auto& [key, item] : value.items()) {  // a std::map, sorted by bytes
      text += separator;
      text += json(key).dump() + ':';
      append_canonical(item, text);
      separator = ',';
    }
    text += value.empty() ? "{}" : "}";
  } else if (value.is_array()) {
    char separator = '[';
    for (const json& item : value) {
      text += separator;
      append_canonical(item, text);
      separator = ',';
    }
    text += value.empty() ? "[]" : "]";
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

std::runtime_error damaged(std::string_view key, std::string_view problem) {
  return std::runtime_error(fmt::format("record of a stage: {} {}", key, problem));
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

StageSpec following(Stage stage, const Parameters& parameters, std::uint64_t seed,
                    const StageSpec& parent) {
  json resolved = resolve(stage, parameters, seed);
  resolved["parent"] = parent.key;
  std::string key = stage_key(resolved);
  return {stage, std::move(key), parent.key, std::move(resolved)};
}

// Values decide which parameters the record must hold; read_parameters refuses what is no value.
json value_in(const json& values, std::string_view key, json otherwise) {
  if (!values.is_object()) return otherwise;
  const auto found = values.find(key);
  return found != values.end() ? *found : std::move(otherwise);
}

Parameters read_parameters_of(Stage stage, const json& values) {
  const json protocol = value_in(values, "protocol", "");
  const std::string name = protocol.is_string() ? protocol.get<std::string>() : "";
  return read_parameters(values, [&](const Field& field) {
    return enters(field, stage, name, value_in(values, field.name, get_value(field, Parameters{})));
  });
}

}  // namespace

std::string_view stage_name(Stage stage) {
  switch (stage) {
    case Stage::shear:
      return "shear";
    case Stage::stiffen:
      return "stiffen";
    case Stage::prepare:
      break;
  }
  return "prepare";
}

StageSpec prepare_stage(const Parameters& parameters, std::uint64_t seed) {
  json resolved = resolve(Stage::prepare, parameters, seed);
  std::string key = stage_key(resolved);
  return {Stage::prepare, std::move(key), "", std::move(resolved)};
}

StageSpec shear_stage(const Parameters& parameters, std::uint64_t seed, const StageSpec& parent) {
  return following(Stage::shear, parameters, seed, parent);
}

StageSpec stiffen_stage(const Parameters& parameters, std::uint64_t seed, const StageSpec& parent) {
  return following(Stage::stiffen, parameters, seed, parent);
}

StageSpec last_stage(const Parameters& parameters, std::uint64_t seed, const StageSpec& parent) {
  const bool stiffens = parameters.protocol == stage_name(Stage::stiffen);
  return following(stiffens ? Stage::stiffen : Stage::shear, parameters, seed, parent);
}

std::string stage_key(const json& resolved) {
  return sha256_hex(std::string(kDomain) + canonical_json(resolved));
}

StageRecord read_stage(const json& resolved) {
  if (!resolved.is_object()) throw std::runtime_error("record of a stage: not a JSON object");
  const std::string name = text_member(resolved, "stage");
  StageRecord record;
  for (const Stage stage : {Stage::shear, Stage::stiffen}) {
    if (name == stage_name(stage)) record.stage = stage;
  }
  if (record.stage != Stage::prepare) {
    record.parent = text_member(resolved, "parent");
    if (!is_sha256_hex(record.parent)) throw damaged("parent", "is not a run's id");
  } else if (name != stage_name(Stage::prepare)) {
    throw damaged("stage", "is none of prepare, shear, stiffen");
  }
  const json& seed = member(resolved, "seed");
  if (!seed.is_number_unsigned()) throw damaged("seed", "is not a whole number >= 0");
  record.seed = seed.get<std::uint64_t>();
  const bool prepares = record.stage == Stage::prepare;
  record.parameters = read_parameters_of(record.stage, member(resolved, "parameters"));
  if (record.parameters != without_what_is_not_felt(record.parameters)) {
    throw damaged("pressure_at", "has no effect on such a run, so it cannot be part of its record");
  }
  if (record.stage == Stage::stiffen) record.parameters.protocol = name;
  // A record of a shear that says it stiffens is one that this program never wrote.
  if (record.stage == Stage::shear && record.parameters.protocol == stage_name(Stage::stiffen)) {
    throw damaged("protocol", "is not one that shears");
  }
  const std::set<std::string> known =
      prepares ? std::set<std::string>{"stage", "seed", "parameters"}
               : std::set<std::string>{"stage", "seed", "parameters", "parent"};
  for (const auto& [key, value] : resolved.items()) {
    if (!known.contains(key)) throw damaged(key.substr(0, 64), "is unknown");
  }
  return record;
}

EngineKind engine_of(const json& resolved) {
  const json none = json::object();
  const json values = value_in(resolved, "parameters", none);
  return value_in(values, "engine", "") == "lammps" ? EngineKind::lammps : EngineKind::shearcell;
}

std::string canonical_json(const json& value) {
  std::string text;
  append_canonical(value, text);
  return text;
}

}  // namespace shearcell
