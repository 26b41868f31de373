// SPDX-License-Identifier: GPL-3.0-or-later
// Which runs and checkpoints of a store belong to a figure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// What a registered manifest says of figures.
struct RegisteredManifest {
  std::string experiment;
  std::string question;
  std::vector<std::string> figures;
};

/// In the order of registration; an experiment may have several. Throws StoreDamaged for an event
/// that does not hold them.
std::vector<RegisteredManifest> registered_manifests(const Store& store);

/// The figure with that name. Throws NotFound that names the nearest figure.
const Figure& figure_called(const std::string& name);

/// What registered manifests ask for.
struct WantedFigures {
  std::vector<const Figure*> figures;  ///< in the order of the supplement
  std::vector<std::string> unknown;    ///< a message for each name that is not a figure's
};
WantedFigures figures_of_store(const Store& store);

/// Figures that need more of a checkpoint first: its one analysis then gives what the others need
/// as well. Otherwise in the order given.
std::vector<const Figure*> in_order_of_needs(std::vector<const Figure*> figures);

/// One run of a figure.
struct CollectedRun {
  RunRecord run;
  Membership membership;
  std::vector<CheckpointRecord> checkpoints;  ///< at whole cycles
};

struct CollectedRuns {
  std::string scale;  ///< one figure never mixes scales
  std::vector<CollectedRun> runs;
};

/// The runs of the experiments that ask for the figure, at one scale (default: the one declared
/// last). A run that two experiments share is one run and ends where the longer of them ends:
/// counted twice, it would make errors too small. A figure of every experiment has it once per
/// experiment. Throws NotFound if there is no such run.
CollectedRuns collect_runs(const Store& store, const Figure& figure,
                           const std::optional<std::string>& scale);

}  // namespace shearcell
