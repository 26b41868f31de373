// SPDX-License-Identifier: GPL-3.0-or-later
// Names for people of settled packings, which no sweep names.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "provenance/records.hpp"

namespace shearcell {

/// "packing", and where an experiment has others at the same scale, what tells them apart: "packing
/// N=600".
class PackingNames {
 public:
  PackingNames() = default;
  explicit PackingNames(const std::vector<RunRecord>& runs);

  /// `resolved`: of the stage that settles it.
  void add(const Membership& place, const nlohmann::json& resolved);
  std::string of(const Membership& place, const nlohmann::json& resolved) const;

 private:
  using Place = std::pair<std::string, std::string>;         // experiment and scale
  std::map<Place, std::vector<nlohmann::json>> parameters_;  // different ones
};

}  // namespace shearcell
