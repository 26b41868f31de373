// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/upcast.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "provenance/errors.hpp"

namespace shearcell {

namespace {

using nlohmann::json;

/// One step of one type, from layout `from` to the next.
struct Step {
  std::string_view type;
  std::uint64_t from;
  void (*convert)(json&);
};

// Null stands for what nobody recorded then. Steps of one type are in ascending order.
constexpr std::array<Step, 3> kSteps = {{
    {"RunStarted", 1,
     [](json& p) {
       p["process"] = nullptr;
       p["parent_checkpoint"] = nullptr;
     }},
    {"RunResumed", 1, [](json& p) { p["process"] = nullptr; }},
    {"RunCompleted", 1, [](json& p) { p["target_cycles"] = nullptr; }},
}};

}  // namespace

std::uint64_t newest_schema(std::string_view type) {
  std::uint64_t newest = 1;
  for (const Step& step : kSteps) {
    if (step.type == type) newest = std::max(newest, step.from + 1);
  }
  return newest;
}

json upcast(std::string_view type, std::uint64_t schema, json payload) {
  if (schema > newest_schema(type)) {
    throw StoreDamaged(
        fmt::format("its payload has layout {}, and this program knows layouts up to {}; use the "
                    "newer shearcell that wrote it",
                    schema, newest_schema(type)));
  }
  for (const Step& step : kSteps) {
    if (step.type != type || step.from < schema) continue;
    step.convert(payload);
  }
  return payload;
}

}  // namespace shearcell
