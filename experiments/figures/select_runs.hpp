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
  std::vector<std::string> states = {};  ///< names of RunState
  bool all_versions = false;  ///< newest_runs(): those of older versions of a manifest too
  bool packings = false;      ///< settled packings too, whose variant is "packing"
};

struct SelectedRun {
  RunRecord run;
  Membership membership;  ///< a run of two experiments is selected once for each
  /// Declared by the newest version of the experiment's manifest that has runs at this scale.
  bool of_newest_version = true;
};

/// In the order of declaration. A run that several versions of a manifest declared is that of the
/// newest. Throws NotFound for an experiment, scale, variant or seed that the store does not have,
/// and names those that it has.
std::vector<SelectedRun> select_runs(const Store& store, const RunSelection& selection);

struct NewestRuns {
  std::vector<SelectedRun> runs;   ///< those of newest versions first
  std::vector<std::string> notes;  ///< what was left out
};

/// Of each experiment at each scale the runs of the newest version of its manifest that has any
/// there; with `all_versions` those of older versions too. Settled packings are left out.
/// Each seed of a variant is listed once: a run counted twice would make errors too small. A run is
/// listed once, or once for each variant of its manifest that is this run. Runs are in the order of
/// experiment, scale, variant and seed, whatever the order of declaration.
NewestRuns newest_runs(std::vector<SelectedRun> selected, bool all_versions);

/// A run that no experiment declared, as a damaged store may hold it, has an empty membership.
Membership first_membership(const RunRecord& run);

}  // namespace shearcell
