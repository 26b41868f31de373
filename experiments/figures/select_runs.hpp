// SPDX-License-Identifier: GPL-3.0-or-later
// Selects runs of a store by the filters --experiment, --scale, --variant, --seed, --state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "provenance/store.hpp"

namespace shearcell {

/// An empty list selects all.
struct RunSelection {
  std::vector<std::string> experiments;
  std::vector<std::string> scales;
  /// "fluid=cell" also selects the variant "fluid=cell,amplitude_rad=0.1".
  std::vector<std::string> variants;
  std::vector<std::uint64_t> seeds;
  std::vector<std::string> states;  ///< names of RunState
  bool all_versions = false;        ///< in a table: runs of older versions of a manifest too
};

struct SelectedRun {
  RunRecord run;
  Membership membership;  ///< a run of two experiments is selected once for each
};

/// In the order of declaration. A run that several versions of a manifest declared is that of the
/// newest. Throws NotFound for an experiment, scale, variant or seed that the store does not have,
/// and names those that it has.
std::vector<SelectedRun> select_runs(const Store& store, const RunSelection& selection);

/// Drops the runs of older versions of an experiment's manifest at a scale; returns how many.
std::size_t drop_older_versions(const Store& store, std::vector<SelectedRun>& runs);

/// A run that no experiment declared, as a damaged store may hold it, has an empty membership.
Membership first_membership(const RunRecord& run);

}  // namespace shearcell
