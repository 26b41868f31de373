// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/report_data.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "analysis/error.hpp"
#include "analysis/plot.hpp"
#include "experiments/figures/collect.hpp"
#include "experiments/report/accuracy_charts.hpp"
#include "experiments/runner/host.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/temporary_folder.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// In the order in which they were first registered, with the question and figures of the newest
/// manifest.
std::vector<ReportExperiment> experiments_of(const Store& store) {
  std::vector<ReportExperiment> found;
  for (RegisteredManifest& manifest : registered_manifests(store)) {
    auto known = std::ranges::find(found, manifest.experiment, &ReportExperiment::name);
    if (known == found.end()) {
      known = found.insert(found.end(), ReportExperiment{manifest.experiment, {}, {}, {}});
    }
    known->question = std::move(manifest.question);
    known->figures = std::move(manifest.figures);
  }
  const std::vector<RunRecord> runs = store.runs();
  for (ReportExperiment& experiment : found) {
    const auto is_member = [&](const Membership& m) { return m.experiment == experiment.name; };
    for (const RunRecord& run : runs) {
      if (std::ranges::any_of(run.memberships, is_member)) experiment.runs.push_back(run);
    }
  }
  return found;
}

std::string draw(const FigureTable& table, const TemporaryFolder& folder) {
  write_csv(table, folder.path());
  std::ifstream svg(draw_svg(table, folder.path()), std::ios::binary);
  return {std::istreambuf_iterator<char>(svg), {}};
}

/// The newest record of the figure that came from the same checkpoints in the same way.
std::optional<FigureRecord> record_of(const std::vector<FigureRecord>& records,
                                      const std::string& name, const json& lineage) {
  for (auto record = records.rbegin(); record != records.rend(); ++record) {
    if (record->name != name || !record->provenance.is_object()) continue;
    const auto same = [&](const char* key) {
      const auto found = record->provenance.find(key);
      return found != record->provenance.end() && *found == lineage.at(key);
    };
    if (same("scale") && same("analysis_version") && same("inputs")) return *record;
  }
  return std::nullopt;
}

ReportFigure figure_of(const Store& store, const Figure& figure, const ReportOptions& options,
                       const std::vector<FigureRecord>& records, ReportData& data) {
  FigureOptions how;
  how.scale = options.scale;
  how.workers = options.workers;
  how.report = options.measured;
  ComputedFigure computed = compute_figure(store, figure, how);
  ReportFigure made;
  made.name = figure.name;
  made.title = figure.title;
  made.summary = std::move(computed.summary);
  made.recorded = record_of(records, made.name, computed.lineage);
  made.lineage = figure_lineage(store, {made.name, 0, "", computed.lineage});
  const TemporaryFolder folder("shearcell-report-");
  for (const FigureTable& table : computed.result.tables) {
    ReportPanel panel{table.name, {}, to_csv(table), table.text, ""};
    if (!table.chart.series.empty()) panel.chart = chart_json(table);
    try {
      if (!data.interactive && table.text.rows.empty()) panel.drawing = draw(table, folder);
    } catch (const AnalysisError& error) {
      data.drawing_trouble = error.what();
    }
    made.panels.push_back(std::move(panel));
  }
  return made;
}

/// The first experiment that asks for the figure; "" if it is about all of them.
std::string experiment_showing(const ReportData& data, const Figure& figure) {
  for (const ReportExperiment& experiment : data.experiments) {
    if (std::ranges::count(experiment.figures, figure.name) > 0) return experiment.name;
  }
  return "";
}

void add_figures(const Store& store, const ReportOptions& options, ReportData& data,
                 Report& report) {
  const std::vector<FigureRecord> records = figure_records(store);
  WantedFigures wanted = figures_of_store(store);
  report.notes = std::move(wanted.unknown);
  std::set<std::string> made;
  for (const Figure* figure : in_order_of_needs(std::move(wanted.figures))) {
    const std::string experiment = experiment_showing(data, *figure);
    if (experiment.empty() && figure->scope != FigureScope::every) continue;  // an older manifest's
    try {
      ReportFigure one = figure_of(store, *figure, options, records, data);
      one.experiment = experiment;
      const FigureSummary& summary = one.summary;
      report.damage.insert(report.damage.end(), summary.damage.begin(), summary.damage.end());
      report.notes.insert(report.notes.end(), summary.pruned.begin(), summary.pruned.end());
      made.insert(one.name);
      data.figures.push_back(std::move(one));
    } catch (const NotFound& missing) {
      report.notes.push_back("figure " + std::string(figure->name) + ": " + missing.what());
    }
  }
  for (ReportExperiment& experiment : data.experiments) {
    std::erase_if(experiment.figures,
                  [&](const std::string& name) { return !made.contains(name); });
  }
}

void add_runs(const Store& store, ReportData& data) {
  for (const ReportExperiment& experiment : data.experiments) {
    for (const RunRecord& run : experiment.runs) {
      if (data.runs.contains(run.id)) continue;
      for (RunLineage& stage : run_lineage(store, run.id)) {
        const std::string id = stage.run.id;
        data.runs.try_emplace(id, std::move(stage));
      }
    }
  }
  for (const ReportFigure& figure : data.figures) {
    for (const ManifestText& manifest : figure.lineage.manifests) {
      data.manifests.try_emplace(manifest.sha256, manifest);
    }
  }
}

}  // namespace

ReportData collect_report(const Store& store, const ReportOptions& options, Report& report) {
  ReportData data;
  data.head = store.head();
  data.store = std::filesystem::absolute(store.folder()).lexically_normal().filename().string();
  data.program = host_facts().at("build");
  data.interactive = options.interactive && has_front_end();
  data.experiments = experiments_of(store);
  if (data.experiments.empty()) {
    throw NotFound(store.folder().string() +
                   ": the store holds no experiment; `shearcell run` one first");
  }
  std::vector<std::string> names;
  for (const ReportExperiment& experiment : data.experiments) names.push_back(experiment.name);
  add_figures(store, options, data, report);
  add_runs(store, data);
  if (options.accuracy) data.accuracy = read_accuracy_charts(*options.accuracy);
  if (data.interactive) {
    data.packings = collect_packings(store, names, options.scale, options.packings, options.workers,
                                     options.packed);
    report.notes.insert(report.notes.end(), data.packings.notes.begin(), data.packings.notes.end());
  }
  return data;
}

}  // namespace shearcell
