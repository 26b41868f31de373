// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/novelty.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace shearcell {
namespace {

using nlohmann::json;

// The parent's id is left out: it differs because of a value that is compared itself.
std::vector<Difference> differences(const json& planned, const json& known) {
  std::vector<Difference> found;
  const json none = json::object();
  const json& mine = planned.at("parameters");
  const json& theirs = known.contains("parameters") ? known.at("parameters") : none;
  for (const auto& [key, value] : mine.items()) {
    const json other = theirs.value(key, json());
    if (other != value) found.push_back({key, value, other});
  }
  const json seed = known.value("seed", json());
  if (planned.at("seed") != seed) found.push_back({"seed", planned.at("seed"), seed});
  return found;
}

}  // namespace

std::optional<Novelty> novelty(const StageSpec& stage, const std::vector<RunRecord>& known) {
  std::optional<Novelty> nearest;
  for (const RunRecord& run : known) {
    if (run.id == stage.key) return std::nullopt;
    if (run.kind != name_of(stage.stage)) continue;
    auto found = differences(stage.resolved, run.resolved);
    if (nearest && nearest->differences.size() <= found.size()) continue;
    nearest = Novelty{run.id, std::move(found)};
  }
  return nearest;
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
