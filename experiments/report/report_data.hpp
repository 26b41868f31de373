// SPDX-License-Identifier: GPL-3.0-or-later
// The data of a report.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiments/figures/draw.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/report/packings.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/lineage.hpp"

namespace shearcell {

struct ReportOptions {
  RunSelection runs;  ///< for figures, tables and packings; a figure has one scale
  PackingChoice packings;
  bool interactive = true;  ///< false: drawings only, as in a build without Node
  std::size_t workers = 1;
  std::function<void(std::size_t done, std::size_t total)> measured;  ///< may be empty
  std::function<void(std::size_t done, std::size_t total)> encoded;   ///< may be empty
};

/// Whether this build holds the front end. Building that needs Node.
bool has_front_end();

struct ReportPanel {
  std::string name;
  std::string id;        ///< in the page: "drag.S2a"
  nlohmann::json chart;  ///< for the front end; null if there is none
  std::string csv;
  TextTable text;       ///< if the panel is a table
  std::string drawing;  ///< SVG, if the page is not interactive
  std::string trouble;  ///< why there is no drawing, if there should be one
};

struct ReportFigure {
  std::string id;  ///< in the page: "drag.S2"
  FigureSummary summary;
  std::vector<ReportPanel> panels;
  FigureLineage lineage;
  std::optional<FigureRecord> recorded;  ///< the newest record with the same inputs
};

struct ReportExperiment {
  RegisteredManifest manifest;  ///< its newest version
  std::string manifest_path = {};
  bool labelled = false;                  ///< the manifest names variants
  std::vector<std::size_t> figures = {};  ///< of ReportData::figures
  std::vector<std::string> unmade = {};   ///< figures that cannot be made of its runs
  std::vector<Stage> runs = {};
  std::size_t checkpoints_left = 0;  ///< checkpoints of unfinished runs if nothing ends them early
  RunTable table = {};               ///< a row for each run, without those that settle packings
  /// For the front end, in the order of the rows: [{id, kind, scale, variant, seed, cycle, phi,
  /// ...}]. The cycle and each scalar measure are arrays over the checkpoints, null where a value
  /// is unknown.
  nlohmann::json traces = nlohmann::json::array();
};

struct ReportData {
  std::string store;  ///< name of its folder
  Head head;
  nlohmann::json program;  ///< build of this program
  std::vector<ReportExperiment> experiments;
  std::vector<ReportFigure> figures;  ///< of `experiments`, and of all experiments together
  RunLineages runs;
  std::map<std::string, ManifestText> manifests;
  Packings packings;
  bool interactive = false;
  std::set<std::string> undrawn;    ///< which drawings failed and why, one line each
  std::vector<std::string> damage;  ///< checkpoints that could not be read, one line each
  std::vector<std::string> notes;   ///< about runs, figures and tables, one line each
};

/// Collects the data. Writes nothing but measures into derived.sqlite. Throws NotFound if the store
/// has no experiment or a run of `packings.runs` is unknown.
ReportData collect_report(const Store& store, const ReportOptions& options);

}  // namespace shearcell
