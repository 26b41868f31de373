// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a figure from stored checkpoints.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "experiments/figures/collect.hpp"
#include "experiments/runner/measure.hpp"

namespace shearcell {

struct FigureOptions : MeasureOptions {
  std::filesystem::path folder;  ///< files go into FOLDER/EXPERIMENT/SCALE, created if missing
  RunSelection runs = {};
  bool wide = false;     ///< drawn as wide as two columns of a journal
  bool recorded = true;  ///< in the log of the store
};

/// A figure: its panels, its verdicts, and what was left out.
struct ComputedFigure : MeasureOutcome, FigureResult {
  std::string name;
  std::string title;
  std::string experiment;  ///< "" for a figure of all experiments
  std::string scale;
  std::map<std::string, std::size_t> runs_by_variant;  ///< by the name of the variant
  std::size_t runs = 0;
  std::size_t checkpoints = 0;
  std::vector<std::string> notes;            ///< as CollectedRuns::notes
  std::vector<std::string> primary;          ///< claims that the manifest lists under `primary`
  std::vector<std::string> empty;            ///< names of tables without a value to draw
  std::string why_empty;                     ///< "Nothing is drawn in S2b: ..."; "" if all is drawn
  std::string caption;                       ///< as in NAME.caption.txt; "" if nothing is drawn
  nlohmann::json lineage;                    ///< the figure's record; draw_figure() adds `outputs`
  std::vector<std::filesystem::path> files;  ///< by draw_figure(): CSV, SVG, PDF of each panel, ...
  std::vector<std::string> undrawn;          ///< why drawings are missing, one line each
};

/// Computes tables, verdicts and inputs of a figure. Writes only measures into derived.sqlite;
/// options.folder is not used. A checkpoint whose measures are cached is not read. A damaged or
/// pruned checkpoint without cached measures is left out and named. Throws NotFound if the store
/// holds no run for the figure, and UsageError if the figure would average over a parameter that
/// the experiment varies.
ComputedFigure compute_figure(const Store& store, const WantedFigure& wanted,
                              const FigureOptions& options);

/// Computes the figure and writes into FOLDER/EXPERIMENT/SCALE (FOLDER/SCALE for a figure of all
/// experiments), where SCALE is scale_name(): PANEL.csv, .svg and, with librsvg, .pdf of each
/// panel, NAME.caption.txt if something is drawn, NAME.verdict.json and NAME.verdict.csv (what
/// entered it) if there are claims, and NAME.lineage.json. Deletes a caption or verdict of an older
/// figure that the new one lacks. Records a FigureGenerated event with host and build, unless
/// options.recorded is false, the newest event of this figure says the same or a drawing failed
/// (gnuplot may be missing). The same checkpoints give the same bytes. Throws as compute_figure()
/// and require_own_files().
ComputedFigure draw_figure(Store& store, const WantedFigure& wanted, const FigureOptions& options);

}  // namespace shearcell
