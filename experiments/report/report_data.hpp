// SPDX-License-Identifier: GPL-3.0-or-later
// What a report shows, before any of it is HTML.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/figures/draw.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/report/packings.hpp"
#include "experiments/report/report.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/lineage.hpp"

namespace shearcell {

struct ReportPanel {
  std::string name;
  std::string id;        ///< in the page: "drag-S2a"
  nlohmann::json chart;  ///< for the front end; null if there is none
  std::string csv;
  TextTable text;       ///< if the panel is a table
  std::string drawing;  ///< SVG, if the page is not interactive and gnuplot is installed
};

struct ReportFigure {
  std::string name;
  std::string title;
  std::string id;          ///< in the page: "drag-S2"
  std::string experiment;  ///< "" when it is about all
  FigureSummary summary;
  std::vector<ReportPanel> panels;
  FigureLineage lineage;
  std::optional<FigureRecord> recorded;  ///< the newest record that says the same
};

struct ReportExperiment {
  std::string name;
  std::string question;
  std::string manifest;  ///< SHA-256 of its newest version
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
  std::string drawing_trouble;  ///< why a figure has no drawing
};

/// Throws as make_report() does. What was left out goes to `report`.
ReportData collect_report(const Store& store, const ReportOptions& options, Report& report);

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
