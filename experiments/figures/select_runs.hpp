// SPDX-License-Identifier: GPL-3.0-or-later
// Selects runs of a store by the filters --experiment, --scale, --variant, --seed, --state.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "provenance/store.hpp"

namespace shearcell {

/// Filters of runs. An empty list selects everything.
struct RunSelection {
  std::vector<std::string> experiments = {};
  std::vector<std::string> scales = {};
  /// Swept values or labels. "fluid=cell" also selects the variant "fluid=cell,amplitude_rad=0.1".
  std::vector<std::string> variants = {};
  std::vector<std::uint64_t> seeds = {};
  std::vector<std::string> states = {};  ///< names of StageState
  bool packings = false;                 ///< also select settled packings (variant "packing")

  bool operator==(const RunSelection&) const = default;
};

/// Returns the selected runs in the order of declaration. Run::name is empty. Throws NotFound for
/// an unknown experiment, scale, variant or seed; the message names known values.
std::vector<Run> select_runs(const Store& store, const RunSelection& selection);

struct NewestRuns {
  std::vector<Run> runs;           ///< sorted by experiment, scale, variant and seed
  std::vector<std::string> notes;  ///< runs that are left out, or shown without their last cycles
};

/// Returns the runs that figures and tables show. These are, for each experiment and scale, the
/// runs of the last registered manifest version that has runs at this scale. Within a variant, each
/// seed is listed once, because counting a run twice would make errors too small. But if variants
/// share a stage, each variant has its own run. Settled packings are left out.
NewestRuns newest_runs(std::vector<Run> selected);

/// The experiment, scale, variant and seed for which the stage was declared first. Empty if no
/// experiment declared the stage, as in a damaged store.
Place first_place(const Stage& stage);

}  // namespace shearcell
