// SPDX-License-Identifier: GPL-3.0-or-later
// What sets a stage that the store does not know apart from the nearest one that it knows.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
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

/// Nothing when the store knows the stage, or none of its kind.
std::optional<Novelty> novelty(const StageSpec& stage, const std::vector<RunRecord>& known);

/// "steps_per_cycle 500 (store has 400), seed 2 (store has 1)".
std::string describe(const Novelty& novelty);

}  // namespace shearcell
