// SPDX-License-Identifier: GPL-3.0-or-later
// What a report shows, before any of it is HTML.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
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
  RunSelection runs;  ///< in figures, tables and packings; figures are of one scale
  /// Folder with the CSV files of `bench accuracy --out`; no such section without it.
  std::optional<std::filesystem::path> accuracy;
  PackingChoice packings;
  bool interactive = true;  ///< false: figures as drawings, as in a build without Node
  std::size_t workers = 1;
  std::function<void(std::size_t done, std::size_t total)> measured;  ///< may be empty
  std::function<void(std::size_t done, std::size_t total)> packed;    ///< may be empty
};

/// Whether this build holds the front end, which needs Node to be built.
bool has_front_end();

struct ReportPanel {
  std::string name;
  std::string id;        ///< in the page: "drag-S2a"
  nlohmann::json chart;  ///< for the front end; null if there is none
  std::string csv;
  TextTable text;       ///< if the panel is a table
  std::string drawing;  ///< SVG, if the page is not interactive and gnuplot is installed
};

struct ReportFigure {
  std::string id;  ///< in the page: "drag-S2"
  FigureSummary summary;
  std::vector<ReportPanel> panels;
  FigureLineage lineage;
  std::optional<FigureRecord> recorded;  ///< the newest record that says the same
};

struct ReportExperiment {
  RegisteredManifest manifest;  ///< its newest version
  std::string manifest_path = {};
  bool labelled = false;                  ///< that version has names for variants
  std::vector<std::size_t> figures = {};  ///< of ReportData::figures
  std::vector<std::string> unmade = {};   ///< figures that its runs do not allow
  std::vector<RunRecord> runs = {};
  RunTable table = {};  ///< a row for each run but those that settle packings
  std::vector<nlohmann::json> traces =
      {};  ///< of each row: {"cycle": [], "phi": [], "percent": []}
};

struct ReportData {
  std::string store;  ///< name of its folder
  Head head;
  nlohmann::json program;  ///< build of the program that makes the report
  std::vector<ReportExperiment> experiments;
  std::vector<ReportFigure> figures;       ///< those of `experiments`, and those about all of them
  std::map<std::string, RunLineage> runs;  ///< by id
  std::map<std::string, ManifestText> manifests;
  std::vector<ReportPanel> accuracy;
  Packings packings;
  bool interactive = false;
  std::string drawing_trouble;      ///< why a figure has no drawing
  std::vector<std::string> damage;  ///< checkpoints that could not be read, one line each
  std::vector<std::string> notes;   ///< what else was left out, likewise
};

/// Reads the store and writes nothing but measures into its derived.sqlite. Throws NotFound when
/// the store has no experiment or a run of `packings.runs` is unknown, and UsageError when the
/// folder of `accuracy` holds no CSV file that this program can read.
ReportData collect_report(const Store& store, const ReportOptions& options);

/// For the front end: [{experiment, runs: [{id, kind, scale, variant, seed, cycle, phi,
/// percent}]}], the runs in the order of the rows of the table; the last three are arrays with null
/// for no value.
nlohmann::json run_traces(const ReportData& data);

/// A panel for each CSV file that `bench accuracy --out` wrote, by name: the numbers, the chart of
/// NAME.chart.json and the drawing of NAME.svg, if there are such files. Files are not trusted.
/// Throws UsageError for a file that is unreadable or too large, a chart that is malformed, and a
/// folder without a CSV file.
std::vector<ReportPanel> read_accuracy_charts(const std::filesystem::path& folder);

}  // namespace shearcell
