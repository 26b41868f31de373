// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the runs and checkpoints of a store that belong to a figure.
#pragma once

#include <map>
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

/// The runs that a manifest plans at one scale.
struct PlannedRuns {
  std::vector<FrameRun> runs;        ///< one for each variant and seed
  std::vector<std::uint64_t> seeds;  ///< in the order of the manifest
  std::vector<std::size_t> looks;
};

/// The newest version of a registered manifest, with what was read from its text.
struct ReadManifest : RegisteredManifest {
  Manifest content;
  mutable std::map<std::string, PlannedRuns> planned = {};  ///< by scale; filled on demand
};
using ReadManifests = std::shared_ptr<const std::vector<ReadManifest>>;

/// A figure of one experiment, or of all experiments ("").
struct WantedFigure {
  Figure figure;
  std::string experiment;
  /// Derived measures that other figures of the experiment need: MeasureOptions::also.
  std::vector<std::string> also = {};
  /// The manifests of the store, shared by the figures of one command, so that each manifest is
  /// read and its variants are expanded once. Null: collect_runs() reads them.
  ReadManifests manifests = {};

  /// "drag/S2", for messages.
  std::string path() const;
};

/// The figures that registered manifests list.
struct WantedFigures {
  /// By experiment: figures in the order of the supplement, then plots and claims. Figures of all
  /// experiments are last.
  std::vector<WantedFigure> figures;
  std::vector<std::string> unknown;  ///< a message for each unknown name
};

/// The figures, plots and claims of the newest manifests: all or those in `names`, of all
/// experiments or of `experiments`. The manifests of `experiments` need not list the figures in
/// `names`. Throws NotFound, with the nearest name, for an unknown figure or experiment.
WantedFigures wanted_figures(const Store& store, const std::vector<std::string>& names = {},
                             const std::vector<std::string>& experiments = {});

/// Removes the figures of experiments without a selected run, unless no figure would be left.
/// Returns a note on them, or "".
std::string leave_out_unselected(const Store& store, const RunSelection& runs,
                                 std::vector<WantedFigure>& figures);

/// Returns the newest_runs() of `selected`, without checkpoints, and adds a line to `notes` for
/// what is left out. Where P acts equally on both walls, the parameters of a run say `pressure_at:
/// top`.
std::vector<FrameRun> frame_runs(std::vector<Run> selected, std::vector<std::string>& notes);

/// Removes the checkpoints without a result of scalars_provider, and limits the end of the run to
/// the cycle that its stage has reached.
void leave_out_unmeasured(FrameRun& run);

/// Measures the checkpoints of the runs, with the cadence that each run's experiment asks for. Adds
/// what could not be read to the outcome.
void measure_runs(const Store& store, std::vector<FrameRun>& runs,
                  std::span<const std::string> providers, const MeasureOptions& options,
                  MeasureOutcome& outcome);

struct CollectedRuns : Frame {
  ReadManifests manifests;  ///< WantedFigure::manifests, read if that is null
  std::string scale;        ///< one figure never mixes scales
  /// Lines on runs that were left out or are not finished, and on checkpoints that were never made.
  std::vector<std::string> notes;
};

/// Returns the selected newest_runs() of the figure's experiment at one scale: the scale of the run
/// that was declared last. Each run has its checkpoints up to end_for(). In a figure of all
/// experiments, a run occurs once for each of its experiments. Throws NotFound if no run is
/// selected.
CollectedRuns collect_runs(const Store& store, const WantedFigure& wanted,
                           const RunSelection& selection, const MeasureOptions& measuring = {});

}  // namespace shearcell
