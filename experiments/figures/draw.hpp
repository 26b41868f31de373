// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a figure from stored checkpoints alone: nothing is simulated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "experiments/figures/collect.hpp"
#include "experiments/runner/measure.hpp"

namespace shearcell {

/// `fresh` measures every checkpoint again, even if the store keeps its measures.
struct FigureOptions : MeasureOptions {
  std::filesystem::path folder;  ///< the files go into its folder EXPERIMENT; created if missing
  RunSelection runs = {};
  bool wide = false;  ///< drawn over two columns of a journal
};

struct FigureSummary : MeasureOutcome {
  std::string name;
  std::string title;
  std::string experiment;  ///< "" if it is about all
  std::string scale;
  std::size_t runs = 0;
  std::size_t checkpoints = 0;
  std::vector<std::filesystem::path> files;  ///< CSV, SVG, PDF of each panel, verdict, lineage
  std::vector<Verdict> verdicts;             ///< on the supplement's claims
  std::vector<std::string> notes;            ///< as CollectedRuns::notes
  std::vector<std::string> empty;            ///< tables without a value to draw
  std::string plot_error;                    ///< why there is no SVG; "" if there is
};

/// A figure before anything is written.
struct ComputedFigure {
  FigureSummary summary;  ///< without files
  FigureResult result;
  std::map<std::string, std::size_t> runs_by_variant;
  nlohmann::json lineage;  ///< as the figure's record has it; `outputs` is empty
};

/// Tables, verdicts and inputs of a figure. Reads the store and writes only measures into
/// derived.sqlite; options.folder is not used. A checkpoint whose measures are kept is not read;
/// one that would have to be read and is damaged or pruned is left out and named. Throws NotFound
/// if the store holds no run for the figure, and UsageError if the figure would average over a
/// parameter that the experiment varies.
ComputedFigure compute_figure(const Store& store, const WantedFigure& wanted,
                              const FigureOptions& options);

/// Computes the figure; writes into FOLDER/EXPERIMENT (FOLDER for a figure of all): PANEL.csv, .svg
/// and, with librsvg, .pdf of each panel, NAME.verdict.json if there are claims (else an
/// older one is deleted), and NAME.lineage.json; and records a FigureGenerated event with host and
/// build, unless the newest event of this figure says the same. The same checkpoints give the same
/// bytes. Throws as compute_figure() and require_own_files().
FigureSummary draw_figure(Store& store, const WantedFigure& wanted, const FigureOptions& options);

}  // namespace shearcell
