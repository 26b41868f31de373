// SPDX-License-Identifier: GPL-3.0-or-later
// The values in which a new stage differs from the nearest known one.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiments/manifest/identity.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// A value that enters a run's identity.
struct Difference {
  std::string field;  ///< "seed", or the key of a parameter
  nlohmann::json planned;
  nlohmann::json known;  ///< in the nearest run
};

struct Novelty {
  std::string nearest;  ///< id of the run of the same kind that differs in the fewest values
  std::vector<Difference> differences;
};

/// The runs of a store, which must outlive this object, prepared for many searches.
class KnownRuns {
 public:
  explicit KnownRuns(const std::vector<RunRecord>& runs);

  /// Null when there is no run with this id.
  const RunRecord* find(const std::string& id) const;

  /// Nothing when the store has the stage, or no stage of its kind.
  std::optional<Novelty> novelty(const StageSpec& stage) const;

 private:
  std::map<std::string_view, const RunRecord*> by_id_;
  struct Kind {
    std::vector<const RunRecord*> runs;
    std::unordered_map<std::string, std::vector<std::size_t>> with;  ///< places by "key=value"
  };
  std::map<std::string_view, Kind> kinds_;
};

/// "steps_per_cycle 500 (store has 400), seed 2 (store has 1)".
std::string describe(const Novelty& novelty);

}  // namespace shearcell
