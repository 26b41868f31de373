// SPDX-License-Identifier: GPL-3.0-or-later
// The values in which a new stage differs from the nearest known one.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiments/manifest/identity.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// An index of the runs of a store for many searches. The runs must outlive this object.
class KnownRuns {
 public:
  explicit KnownRuns(const std::vector<RunRecord>& runs);

  /// Null when there is no run with this id.
  const RunRecord* find(const std::string& id) const;

  /// {"nearest": ID, "fields": [{"field": KEY, "value": V, "store_has": W}, ...]}: the run of the
  /// same kind that differs from this stage in the fewest values, and those values, the seed last.
  /// Null when there is no run of its kind.
  nlohmann::json novelty(const StageSpec& stage) const;

 private:
  std::map<std::string_view, const RunRecord*> by_id_;
  struct Kind {
    std::vector<const RunRecord*> runs;
    std::unordered_map<std::string, std::vector<std::size_t>> with;  ///< places by "key=value"
  };
  std::map<std::string_view, Kind> kinds_;
};

/// "steps_per_cycle 500 (store has 400), seed 2 (store has 1)".
std::string describe_novelty(const nlohmann::json& novelty);

}  // namespace shearcell
