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
  json values =
      resolved.is_object() ? resolved.value("parameters", json::object()) : json::object();
  if (!values.is_object()) values = json::object();
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

}  // namespace

KnownRuns::KnownRuns(const std::vector<RunRecord>& runs) {
  for (const RunRecord& run : runs) {
    by_id_.emplace(run.id, &run);
    kinds_[run.kind].runs.push_back(&run);
    const json values = values_of(run.resolved);
    for (const auto& [key, value] : values.items()) {
      columns_.try_emplace(key, columns_.size());
    }
  }
  numbers_.resize(columns_.size());
  for (auto& [name, kind] : kinds_) {
    for (const RunRecord* run : kind.runs) {
      const std::size_t row = kind.rows.size();
      kind.rows.resize(row + columns_.size());
      const json values = values_of(run->resolved);
      for (const auto& [key, value] : values.items()) {
        const std::size_t column = columns_.at(key);
        const auto next = static_cast<std::uint32_t>(numbers_[column].size() + 1);
        kind.rows[row + column] = numbers_[column].try_emplace(value.dump(), next).first->second;
      }
    }
  }
}

const RunRecord* KnownRuns::find(const std::string& id) const {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : found->second;
}

std::optional<Novelty> KnownRuns::novelty(const StageSpec& stage) const {
  const auto found = kinds_.find(name_of(stage.stage));
  if (found == kinds_.end() || find(stage.key) != nullptr) return std::nullopt;
  constexpr std::uint32_t kUnknown = UINT32_MAX;
  // Values that only the known runs have do not count.
  std::vector<std::uint32_t> planned(columns_.size(), 0), counts(columns_.size(), 0);
  const json values = values_of(stage.resolved);
  for (const auto& [key, value] : values.items()) {
    const auto column = columns_.find(key);
    if (column == columns_.end()) continue;  // no run has it, so it does not decide
    const auto& numbers = numbers_[column->second];
    const auto number = numbers.find(value.dump());
    planned[column->second] = number == numbers.end() ? kUnknown : number->second;
    counts[column->second] = 1;
  }
  const auto& [runs, rows] = found->second;
  std::size_t nearest = 0;
  std::uint32_t fewest = kUnknown;
  for (std::size_t r = 0; r < runs.size() && fewest > 1; ++r) {
    const std::uint32_t* row = rows.data() + r * planned.size();
    std::uint32_t different = 0;
    for (std::size_t c = 0; c < planned.size(); ++c) {
      different += counts[c] & static_cast<std::uint32_t>(row[c] != planned[c]);
    }
    if (different < fewest) {
      fewest = different;
      nearest = r;
    }
  }
  const RunRecord& run = *runs[nearest];
  return Novelty{run.id, differences(values, values_of(run.resolved))};
}

std::string describe(const Novelty& novelty) {
  constexpr std::size_t kNamed = 3;
  std::string text;
  const std::size_t count = novelty.differences.size();
  for (std::size_t i = 0; i < std::min(kNamed, count); ++i) {
    const Difference& d = novelty.differences[i];
    const std::string known = d.known.is_null() ? "none" : d.known.dump();
    text +=
        fmt::format("{}{} {} (store has {})", i == 0 ? "" : ", ", d.field, d.planned.dump(), known);
  }
  if (count > kNamed) text += fmt::format(" and {} more", count - kNamed);
  return text;
}

}  // namespace shearcell
