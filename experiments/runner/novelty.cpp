// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/novelty.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace shearcell {
namespace {

using nlohmann::json;

// Parameters and seed. The parent's id is left out: it differs because of a value that is compared
// itself.
json values_of(const json& resolved) {
  json values = felt_parameters(resolved);
  if (resolved.is_object()) values["seed"] = resolved.value("seed", json());
  return values;
}

std::vector<Difference> differences(const json& planned, const json& known) {
  std::vector<Difference> found;
  for (const auto& [key, value] : planned.items()) {
    const json other = known.value(key, json());
    if (other != value) found.push_back({key, value, other});
  }
  // The seed follows the parameters.
  std::ranges::stable_partition(found, [](const Difference& d) { return d.field != "seed"; });
  return found;
}

std::string short_text(const json& value) {
  return value.is_null()           ? "none"
         : value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                                   : value.dump();
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

std::optional<Novelty> KnownRuns::novelty(const StageSpec& stage) const {
  const auto found = kinds_.find(name_of(stage.stage));
  if (found == kinds_.end() || find(stage.key) != nullptr) return std::nullopt;
  const auto& [runs, known] = found->second;
  std::vector<std::size_t> hits(runs.size(), 0);  // values that each shares with the stage
  const json values = values_of(stage.resolved);
  for (const auto& [key, value] : values.items()) {
    const auto with = known.find(text_of(key, value));
    // What all have does not decide.
    if (with == known.end() || with->second.size() == runs.size()) continue;
    for (const std::size_t place : with->second) ++hits[place];
  }
  const RunRecord& run =
      *runs[static_cast<std::size_t>(std::distance(hits.begin(), std::ranges::max_element(hits)))];
  return Novelty{run.id, differences(values, values_of(run.resolved))};
}

std::string describe(const Novelty& novelty) {
  constexpr std::size_t kNamed = 3;
  std::string text;
  const std::size_t count = novelty.differences.size();
  for (std::size_t i = 0; i < std::min(kNamed, count); ++i) {
    const Difference& d = novelty.differences[i];
    std::string planned = short_text(d.planned), known = short_text(d.known);
    if (planned == known) planned = d.planned.dump(), known = d.known.dump();
    text += fmt::format("{}{} {} (store has {})", i == 0 ? "" : ", ", d.field, planned, known);
  }
  if (count > kNamed) text += fmt::format(" and {} more", count - kNamed);
  return text;
}

}  // namespace shearcell
