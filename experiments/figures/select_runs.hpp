// SPDX-License-Identifier: GPL-3.0-or-later
// Selects runs of a store by the filters --experiment, --scale, --variant, --seed, --state.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "provenance/store.hpp"

namespace shearcell {

/// An empty list selects all.
struct RunSelection {
  std::vector<std::string> experiments = {};
  std::vector<std::string> scales = {};
  /// Values or labels: "fluid=cell" also selects the variant "fluid=cell,amplitude_rad=0.1".
  std::vector<std::string> variants = {};
  std::vector<std::uint64_t> seeds = {};
  std::vector<std::string> states = {};  ///< names of StageState
  bool packings = false;                 ///< settled packings too, whose variant is "packing"

  bool operator==(const RunSelection&) const = default;
};

/// Returns the runs in the order of declaration, without names. Throws NotFound for an unknown
/// experiment, scale, variant or seed, and names the known ones.
std::vector<Run> select_runs(const Store& store, const RunSelection& selection);

struct NewestRuns {
  std::vector<Run> runs;           ///< by experiment, scale, variant and seed
  std::vector<std::string> notes;  ///< what was left out
};

/// Returns the runs that figures and tables show: for each experiment and scale, the runs of the
/// manifest's version that was registered last and has runs at that scale. Each seed of a variant
/// is listed once, because a run that is counted twice would make errors too small. A stage that is
/// several variants is listed for each of them. Settled packings are left out.
NewestRuns newest_runs(std::vector<Run> selected);

/// The first recorded place of the stage; an empty one for a stage that no experiment declared, as
/// in a damaged store.
Place first_place(const Stage& stage);

}  // namespace shearcell
