// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/packing_names.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/manifest/variants.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

PackingNames::PackingNames(const std::vector<RunRecord>& runs) {
  for (const RunRecord& run : runs) {
    if (run.kind != "prepare") continue;
    for (const Membership& place : run.memberships) add(place, run.resolved);
  }
}

void PackingNames::add(const Membership& place, const nlohmann::json& resolved) {
  std::vector<nlohmann::json>& known = parameters_[{place.experiment, place.scale}];
  nlohmann::json parameters = member_of(resolved, "parameters");
  if (std::ranges::find(known, parameters) == known.end()) known.push_back(std::move(parameters));
}

std::string PackingNames::of(const Membership& place, const nlohmann::json& resolved) const {
  const auto known = parameters_.find({place.experiment, place.scale});
  if (known == parameters_.end() || known->second.size() < 2) return "packing";
  const auto names = variant_names(known->second, {});
  const auto own = names.find(member_of(resolved, "parameters"));
  return own == names.end() ? "packing" : fmt::format("packing {}", own->second);
}

}  // namespace shearcell
