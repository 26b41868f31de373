// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/novelty.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/manifest/suggest.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

// Parameters and seed. The parent's id is left out: it differs because of a value that is compared
// itself.
json values_of(const json& resolved) {
  json values = effective_parameters(resolved);
  if (resolved.is_object()) values["seed"] = resolved.value("seed", json());
  return values;
}

std::string text_of(const std::string& key, const json& value) {
  return fmt::format("{}={}", key, value.dump());
}

}  // namespace

KnownRuns::KnownRuns(const std::vector<RunRecord>& runs) {
  for (const RunRecord& run : runs) {
    by_id_.emplace(run.id, &run);
    Kind& kind = kinds_[run.kind];
    const json values = values_of(run.resolved);
    for (const auto& [key, value] : values.items()) {
      kind.with[text_of(key, value)].push_back(kind.runs.size());
    }
    kind.runs.push_back(&run);
  }
}

const RunRecord* KnownRuns::find(const std::string& id) const {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : found->second;
}

json KnownRuns::novelty(const StageSpec& stage) const {
  const auto found = kinds_.find(name_of(stage.stage));
  if (found == kinds_.end()) return nullptr;
  const auto& [runs, known] = found->second;
  std::vector<std::size_t> hits(runs.size(), 0);  // values that each shares with the stage
  const json values = values_of(stage.resolved);
  for (const auto& [key, value] : values.items()) {
    const auto with = known.find(text_of(key, value));
    // A value that all runs have does not distinguish them.
    if (with == known.end() || with->second.size() == runs.size()) continue;
    for (const std::size_t place : with->second) ++hits[place];
  }
  const RunRecord& run =
      *runs[static_cast<std::size_t>(std::distance(hits.begin(), std::ranges::max_element(hits)))];
  const json nearest = values_of(run.resolved);
  std::vector<json> fields;
  for (const auto& [key, value] : values.items()) {
    const json other = nearest.value(key, json());
    if (other != value) fields.push_back({{"field", key}, {"value", value}, {"store_has", other}});
  }
  std::stable_partition(fields.begin(), fields.end(),
                        [](const json& d) { return d["field"] != "seed"; });
  return {{"nearest", run.id}, {"fields", fields}};
}

std::string describe_novelty(const json& novelty) {
  std::vector<std::string> parts;
  for (const json& field : novelty.at("fields")) {
    const json &value = field["value"], &other = field["store_has"];
    std::string planned = short_text(value), known = other.is_null() ? "none" : short_text(other);
    if (planned == known) planned = value.dump(), known = other.dump();
    const std::string name = field["field"];
    parts.push_back(fmt::format("{} {} (store has {})", name, planned, known));
  }
  return some_of(parts);
}

}  // namespace shearcell
