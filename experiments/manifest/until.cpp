// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/until.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "provenance/limits.hpp"

namespace shearcell {

nlohmann::json to_json(const Until& until) {
  return {{std::string(name_of(until.measure)), until.value}, {"extra_cycles", until.extra_cycles}};
}

Until until_from_json(const nlohmann::json& json) {
  for (const Named<StopMeasure>& entry : kNames<StopMeasure>) {
    const std::string name(entry.name);
    if (!json.is_object() || !json.contains(name)) continue;
    const auto extra = json.find("extra_cycles");
    if (json.size() != 2 || !json.at(name).is_number() || extra == json.end() ||
        !extra->is_number_unsigned() || *extra > StoreLimits::cycles) {
      break;
    }
    return {entry.value, json.at(name).get<double>(), extra->get<std::uint64_t>()};
  }
  throw std::runtime_error("until: is not {MEASURE: VALUE, extra_cycles: N}, N at most 1000000");
}

std::string describe(const Until& until) {
  std::string text = fmt::format("{} >= {}", name_of(until.measure), until.value);
  if (until.extra_cycles > 0) text += fmt::format(" and {} cycles more", until.extra_cycles);
  return text;
}

}  // namespace shearcell
