// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/parameters.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/manifest/schema.hpp"

namespace shearcell {

nlohmann::json to_json(const Parameters& parameters) {
  nlohmann::json json = nlohmann::json::object();
  for (const Field& field : schema()) json[std::string(field.name)] = get_value(field, parameters);
  return json;
}

Parameters read_parameters(const nlohmann::json& json,
                           const std::function<bool(const Field&)>& expected) {
  if (!json.is_object()) throw std::runtime_error("parameters: not a JSON object");
  for (const auto& [key, value] : json.items()) {
    const Field* field = find_field(key);
    if (field == nullptr || !expected(*field)) {
      throw std::runtime_error(fmt::format("parameters: unknown key {:.64}", key));
    }
  }
  Parameters parameters;
  for (const Field& field : schema()) {
    if (!expected(field)) continue;
    const auto found = json.find(std::string(field.name));
    if (found == json.end()) {
      throw std::runtime_error(fmt::format("parameters: {} is missing", field.name));
    }
    if (const auto wrong = check_value(field, *found)) {
      throw std::runtime_error(
          fmt::format("parameters: {} {}. {}", field.name, wrong->problem, wrong->remedy));
    }
    set_value(field, *found, parameters);
  }
  return parameters;
}

Parameters parameters_from_json(const nlohmann::json& json) {
  return read_parameters(json, [](const Field&) { return true; });
}

}  // namespace shearcell
