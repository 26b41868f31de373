// SPDX-License-Identifier: GPL-3.0-or-later
// Which runs and checkpoints of a store belong to a figure.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "experiments/figures/select_runs.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// A figure of one experiment, or of all ("").
struct WantedFigure {
  Figure figure;
  std::string experiment;

  /// "drag/S2": names its record, and its files below the folder for figures.
  std::string path() const;
};

/// The figures that registered manifests list.
struct WantedFigures {
  /// By experiment; in each those of the supplement in its order, then plots and claims.
  std::vector<WantedFigure> figures;
  std::vector<std::string> unknown;  ///< a message for each name that is not a figure's
};

/// The figures, plots and claims that the newest manifests state: all, or those with one of
/// `names`; of all experiments, or of `experiments`, which then need not list them. Throws
/// NotFound, with the nearest name, for a name that is not a figure's or an experiment's.
WantedFigures wanted_figures(const Store& store, const std::vector<std::string>& names = {},
                             const std::vector<std::string>& experiments = {});

/// Figures that need more of a checkpoint first: its one analysis then gives what the others need
/// as well. Otherwise in the order given.
std::vector<WantedFigure> in_order_of_needs(std::vector<WantedFigure> figures);

/// One run of a figure.
struct CollectedRun : SelectedRun {
  std::vector<CheckpointRecord> checkpoints = {};  ///< own_checkpoints()
  std::string name = {};                           ///< of its variant, for people
  bool named = false;                              ///< by a label of the manifest
  double end = 0;                                  ///< own_end()
};

struct CollectedRuns {
  std::string scale;  ///< one figure never mixes scales
  std::vector<CollectedRun> runs;
  /// Runs that were left out or are not finished, checkpoints that were never made.
  std::vector<std::string> notes;
};

/// The newest_runs() of the experiment among those selected, at the scale declared last. (A figure
/// of every experiment has a run once per experiment.) Those of older versions of the manifest have
/// a variant of their own, "fluid=cell,manifest=1f2e3d4c". Each has its checkpoints up to
/// own_end(). Throws NotFound if there is no such run.
CollectedRuns collect_runs(const Store& store, const WantedFigure& wanted,
                           const RunSelection& selection, const MeasureOptions& measuring = {});

}  // namespace shearcell
