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
  /// "fluid=cell" also selects the variant "fluid=cell,amplitude_rad=0.1".
  std::vector<std::string> variants = {};
  std::vector<std::uint64_t> seeds = {};
  std::vector<std::string> states = {};  ///< names of StageState
  bool packings = false;                 ///< settled packings too, whose variant is "packing"
};

/// In the order of declaration, without names. Of a run whose manifest was later declared with
/// another one in its place, `newest` is false. Throws NotFound for an experiment, scale, variant
/// or seed that the store does not have, and names those that it has.
std::vector<Run> select_runs(const Store& store, const RunSelection& selection);

struct NewestRuns {
  std::vector<Run> runs;           ///< by experiment, scale, variant and seed
  std::vector<std::string> notes;  ///< what was left out
};

/// The runs that figures and tables show: those of each manifest as it stands, the version
/// registered last of those that have runs at the scale. Each seed of a variant is listed once: a
/// run counted twice would make errors too small. A run that is several variants is listed for
/// each. Settled packings are left out.
NewestRuns newest_runs(std::vector<Run> selected);

/// A run that no experiment declared, as a damaged store may hold it, has an empty ask.
Ask first_ask(const Stage& run);

}  // namespace shearcell
