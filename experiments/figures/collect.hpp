// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the runs and checkpoints of a store that belong to a figure.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "experiments/figures/select_runs.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/runner/measure.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// The newest_manifests() of a store.
using ReadManifests = std::shared_ptr<const std::vector<RegisteredManifest>>;

struct WantedFigure {
  Figure figure;
  std::string experiment;  ///< "" for a figure of all experiments
  /// Providers that other figures of the experiment need, for MeasureOptions::also.
  std::vector<std::string> also = {};
  /// The manifests of the store. All figures of one command share them, so that each manifest is
  /// read only once. If null, collect_runs() reads the manifests.
  ReadManifests manifests = {};
  /// A note with the version of this program if the program's own plots are used, else "". The
  /// program's own plots are used if the manifest defines none for this figure. (Older manifests
  /// only list names of figures.)
  std::string plots = {};

  /// "drag/S2", for messages.
  std::string path() const;
};

/// The figures that are listed or defined in registered manifests.
struct WantedFigures {
  /// Sorted by experiment. Figures across experiments come last. Within an experiment, figures
  /// that the manifest lists in `figures` come before figures that its `plots` and `claims` define.
  std::vector<WantedFigure> figures;
  std::vector<std::string> unknown;  ///< a message for each unknown name
};

/// Returns the figures, plots and claims with these names from the newest manifests of these
/// experiments. An empty list excludes nothing. If both lists are given, a named figure of
/// all_figures() is returned for each experiment, even if its manifest does not list the figure.
/// Throws NotFound for an unknown figure or experiment; the message proposes the nearest name.
WantedFigures wanted_figures(const Store& store, const std::vector<std::string>& names = {},
                             const std::vector<std::string>& experiments = {});

/// Removes the figures of experiments without a selected run, and returns a note that names these
/// experiments. If no run at all is selected, removes no figure and returns "".
std::string leave_out_unselected(const Store& store, const RunSelection& runs,
                                 std::vector<WantedFigure>& figures);

/// Returns the newest_runs() of `selected`; FrameRun::checkpoints is empty. If runs are left out,
/// adds lines about them to `notes`. In runs on which the key `pressure_at` has no effect, the key
/// is set to `top`.
std::vector<FrameRun> frame_runs(std::vector<Run> selected, std::vector<std::string>& notes);

/// Removes the checkpoints for which scalars_provider has no result. Limits FrameRun::end to the
/// cycle that the run's stage has reached.
void leave_out_unmeasured(FrameRun& run);

/// Measures the checkpoints of the runs. Some measures also need an earlier checkpoint. An earlier
/// checkpoint at a whole cycle is used only if this cycle is a multiple of Ask::checkpoint_every.
MeasureOutcome measure_runs(const Store& store, std::vector<FrameRun>& runs,
                            std::span<const std::string> providers, const MeasureOptions& options);

struct CollectedRuns : Frame {
  ReadManifests manifests;  ///< WantedFigure::manifests; if these are null, the store's manifests
  std::string scale;        ///< the scale of all runs: a figure never mixes scales
  /// Messages on runs that were left out, on unfinished runs and on missing checkpoints.
  std::vector<std::string> notes;
};

/// Selects runs of the figure's experiments by `selection`, and keeps those with the scale of the
/// last declared run. Returns the newest_runs() of the kept runs, with the checkpoints that the
/// figure needs, up to FrameRun::end. In a figure of all experiments, a run that belongs to several
/// experiments occurs once for each experiment. Throws NotFound if no run is selected.
CollectedRuns collect_runs(const Store& store, const WantedFigure& wanted,
                           const RunSelection& selection, const MeasureOptions& measuring = {});

}  // namespace shearcell
