// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the runs and checkpoints of a store that belong to a figure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "experiments/figures/select_runs.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// A figure of one experiment, or of all experiments ("").
struct WantedFigure {
  Figure figure;
  std::string experiment;
  /// Derived measures that other figures of the experiment need: MeasureOptions::also.
  std::vector<std::string> also = {};

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

/// The newest_runs() of these, without checkpoints; adds what is left out to `notes`. Their
/// parameters say `pressure_at: top` where P acts equally on both walls.
std::vector<FrameRun> frame_runs(std::vector<Run> selected, std::vector<std::string>& notes);

/// Removes the checkpoints that lack scalars_provider; the run ends where its stage has ended so
/// far.
void leave_out_unmeasured(FrameRun& run);

/// Measures the checkpoints of the runs, with the cadence that each run's experiment asks for. Adds
/// what could not be read to the outcome.
void measure_runs(const Store& store, std::vector<FrameRun>& runs,
                  std::span<const std::string> providers, const MeasureOptions& options,
                  MeasureOutcome& outcome);

struct CollectedRuns : Frame {
  std::string scale;  ///< one figure never mixes scales
  /// Runs that were left out or are not finished, checkpoints that were never made.
  std::vector<std::string> notes;
};

/// The selected newest_runs() of the figure's experiment, at the scale that was declared last, with
/// their checkpoints up to end_for(). A figure of all experiments has a run once per experiment.
/// Throws NotFound if there is no such run.
CollectedRuns collect_runs(const Store& store, const WantedFigure& wanted,
                           const RunSelection& selection, const MeasureOptions& measuring = {});

}  // namespace shearcell
