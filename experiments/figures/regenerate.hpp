// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a figure again from stored checkpoints alone: nothing is simulated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct RegenerateOptions {
  std::filesystem::path folder;      ///< made when missing
  std::optional<std::string> scale;  ///< default: the one that was declared last
  std::size_t workers = 1;
  bool fresh = false;  ///< measure every checkpoint again, whatever the store keeps
  std::function<void(std::size_t done, std::size_t total)> report;  ///< may be empty
};

struct RegeneratedFigure {
  std::string name;
  std::string scale;
  std::size_t runs = 0;
  std::size_t checkpoints = 0;
  std::size_t measured = 0;                  ///< checkpoints that were analysed for it now
  std::vector<std::filesystem::path> files;  ///< CSV, SVG, PDF of each panel, verdict, lineage
  std::vector<Verdict> verdicts;             ///< on what the supplement claims of it
  std::vector<std::string> damage;           ///< checkpoints that could not be read, one line each
  std::vector<std::string> pruned;           ///< checkpoints whose files were pruned, likewise
  std::vector<std::string> changed;          ///< checkpoints whose kept measures were others
  std::string cache_trouble;                 ///< why measures cannot be kept; "" when they can
  std::string plot_error;                    ///< why there is no SVG; empty when there is
};

/// A figure as it is before anything is written.
struct ComputedFigure {
  RegeneratedFigure about;  ///< without files
  FigureResult result;
  nlohmann::json lineage;  ///< as the record of the figure has it; `outputs` is empty
};

/// Names of the figures that some registered manifest asks for, and of those of every experiment.
std::vector<std::string> figures_of_store(const Store& store);

/// Those that need more of a checkpoint come first: its one analysis then gives what the others
/// need as well. Otherwise in the order given.
std::vector<const Figure*> in_order_of_needs(std::vector<const Figure*> figures);

/// The tables and verdicts of a figure, and what they come from. Reads the store, and writes
/// nothing but measures into derived.sqlite. `folder` is not used. Throws as regenerate() does.
ComputedFigure compute_figure(const Store& store, const Figure& figure,
                              const RegenerateOptions& options);

/// Writes FOLDER/PANEL.csv, .svg and, with librsvg, .pdf for each panel, FOLDER/NAME.verdict.json
/// and FOLDER/NAME.lineage.json, and records a FigureGenerated event, with the host and build that
/// made it, unless the newest one says the same. The same checkpoints give the same bytes. A
/// checkpoint whose measures the store keeps is not read; one that would have to be, and cannot or
/// was pruned, is left out and named. Throws NotFound when the store holds no run for the figure.
RegeneratedFigure regenerate(Store& store, const Figure& figure, const RegenerateOptions& options);

}  // namespace shearcell
