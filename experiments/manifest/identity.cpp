// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/identity.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>

#include "experiments/manifest/schema.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

// Changes with the meaning of a key, so that keys of different meanings never meet.
constexpr std::string_view kDomain = "shearcell stage 1\n";

bool enters_prepare(const Field& field) {
  return field.identity == Identity::prepare;
}

// A sheared cell feels what it settled under as well.
bool enters_shear(const Field& field) {
  return field.identity != Identity::none;
}

json resolve(Stage stage, const Parameters& parameters, std::uint64_t seed) {
  const auto enters = stage == Stage::prepare ? enters_prepare : enters_shear;
  json values = json::object();
  for (const Field& field : schema()) {
    if (enters(field)) values[std::string(field.name)] = get_value(field, parameters);
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

}  // namespace

std::string_view stage_name(Stage stage) {
  return stage == Stage::prepare ? "prepare" : "shear";
}

StageSpec prepare_stage(const Parameters& parameters, std::uint64_t seed) {
  json resolved = resolve(Stage::prepare, parameters, seed);
  std::string key = stage_key(resolved);
  return {Stage::prepare, std::move(key), "", std::move(resolved)};
}

StageSpec shear_stage(const Parameters& parameters, std::uint64_t seed, const StageSpec& parent) {
  json resolved = resolve(Stage::shear, parameters, seed);
  resolved["parent"] = parent.key;
  std::string key = stage_key(resolved);
  return {Stage::shear, std::move(key), parent.key, std::move(resolved)};
}

std::string stage_key(const json& resolved) {
  return sha256_hex(std::string(kDomain) + canonical_json(resolved));
}

StageRecord read_stage(const json& resolved) {
  if (!resolved.is_object()) throw std::runtime_error("record of a stage: not a JSON object");
  const std::string name = text_member(resolved, "stage");
  StageRecord record;
  if (name == stage_name(Stage::shear)) {
    record.stage = Stage::shear;
    record.parent = text_member(resolved, "parent");
    if (!is_sha256_hex(record.parent)) throw damaged("parent", "is not a run's id");
  } else if (name != stage_name(Stage::prepare)) {
    throw damaged("stage", "is neither prepare nor shear");
  }
  const json& seed = member(resolved, "seed");
  if (!seed.is_number_unsigned()) throw damaged("seed", "is not a whole number >= 0");
  record.seed = seed.get<std::uint64_t>();
  const bool prepares = record.stage == Stage::prepare;
  record.parameters =
      read_parameters(member(resolved, "parameters"), prepares ? enters_prepare : enters_shear);
  const std::set<std::string> known =
      prepares ? std::set<std::string>{"stage", "seed", "parameters"}
               : std::set<std::string>{"stage", "seed", "parameters", "parent"};
  for (const auto& [key, value] : resolved.items()) {
    if (!known.contains(key)) throw damaged(key.substr(0, 64), "is unknown");
  }
  return record;
}

std::string canonical_json(const json& value) {
  std::string text;
  append_canonical(value, text);
  return text;
}

}  // namespace shearcell
