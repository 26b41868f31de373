// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a figure from stored checkpoints.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/figures/collect.hpp"
#include "experiments/runner/measure.hpp"

namespace shearcell {

struct FigureOptions : MeasureOptions {
  std::filesystem::path folder;  ///< files go into FOLDER/EXPERIMENT/SCALE, created if missing
  RunSelection runs = {};
  bool wide = false;     ///< draw panels two journal columns wide instead of one
  bool recorded = true;  ///< record the figure in the log of the store
};

/// A figure with its panels and verdicts, and messages on everything that was left out.
struct ComputedFigure : MeasureOutcome, FigureResult {
  std::string name;
  std::string title;
  std::string experiment;  ///< "" for a figure of all experiments
  std::string scale;
  /// Number of runs, by name of the variant. The variants are in the order of their swept values.
  nlohmann::ordered_map<std::string, std::size_t> runs_by_variant;
  std::size_t runs = 0;
  std::size_t checkpoints = 0;
  std::size_t unmeasured = 0;  ///< ended runs that lack measures of a checkpoint that is not pruned
  std::vector<std::string> notes;            ///< CollectedRuns::notes, and why values are missing
  std::vector<std::string> empty;            ///< names of tables without a value to draw
  std::string why_empty;                     ///< "Nothing is drawn in S2b: ..."; "" if all is drawn
  std::string caption;                       ///< text of NAME.caption.txt; "" if nothing is drawn
  nlohmann::json lineage;                    ///< the figure's record; draw_figure() adds `outputs`
  std::vector<std::filesystem::path> files;  ///< all files that draw_figure() wrote
  std::vector<std::string> undrawn;  ///< for each drawing that failed, a line with the reason
};

/// Computes the tables, verdicts and lineage of a figure. Writes only measures, into
/// derived.sqlite, and does not use options.folder. Reads no checkpoint whose measures are cached.
/// A damaged or pruned checkpoint without cached measures is left out, and the result names it.
/// Throws NotFound if the store has no run for the figure, and UsageError if the figure would
/// average over a parameter that the experiment varies.
ComputedFigure compute_figure(const Store& store, const WantedFigure& wanted,
                              const FigureOptions& options);

/// Computes the figure and writes these files into FOLDER/EXPERIMENT/SCALE, where SCALE is
/// scale_name(). If ComputedFigure::experiment is empty, the folder is FOLDER/SCALE.
/// - for each panel: PANEL.csv, PANEL.svg, and PANEL.pdf if librsvg is installed
/// - NAME.caption.txt, if something is drawn
/// - NAME.verdict.json, and NAME.verdict.csv with the numbers of each run, if there are claims
/// - NAME.lineage.json
/// Deletes an older caption if the figure has no caption, and older verdicts if it has no claims.
/// Records a FigureGenerated event with host and build. Records no event if options.recorded is
/// false, if the newest event of this figure has the same content, or if a drawing failed although
/// gnuplot is installed. The same checkpoints give the same bytes. Throws the errors of
/// compute_figure() and require_own_files().
ComputedFigure draw_figure(Store& store, const WantedFigure& wanted, const FigureOptions& options);

}  // namespace shearcell
