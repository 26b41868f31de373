// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/report_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

#include "analysis/error.hpp"
#include "analysis/plot.hpp"
#include "experiments/figures/collect.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/look.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// The experiments named, or all, in the order in which they were first registered, each with its
/// newest manifest.
std::vector<ReportExperiment> experiments_of(const Store& store,
                                             const std::vector<std::string>& names) {
  std::vector<ReportExperiment> found;
  for (RegisteredManifest& manifest : newest_manifests(store)) {
    if (!names.empty() && std::ranges::count(names, manifest.experiment) == 0) continue;
    const std::optional<Manifest> known = parsed(manifest);
    ReportExperiment& experiment = found.emplace_back();
    experiment.manifest = std::move(manifest);
    experiment.labelled = known && !known->labels.empty();
  }
  const std::vector<Stage> runs = store.stages();
  for (ReportExperiment& experiment : found) {
    const auto is_member = [&](const Ask& m) {
      return m.experiment == experiment.manifest.experiment;
    };
    for (const Stage& run : runs) {
      if (std::ranges::any_of(run.asks, is_member)) experiment.runs.push_back(run);
    }
  }
  return found;
}

std::string draw(const FigureTable& table) {
  const TemporaryFolder folder("shearcell-report-");
  constexpr std::size_t most = 64'000'000;
  std::optional<std::string> svg = read_plain(draw_svg(table, folder.path()), most);
  if (!svg) throw AnalysisError(fmt::format("{}.svg is larger than {} bytes", table.name, most));
  return std::move(*svg);
}

/// Whether the record is of the same figure, with the same scale, states and analysis version.
bool is_record_of(const Store& store, const FigureRecord& record, const FigureLineage& lineage) {
  if (figure_name(record) != figure_name(lineage.record)) return false;
  const auto key = [](const FigureInput& i) {
    return std::tie(i.run, i.experiment, i.variant, i.seed, i.manifest, i.overrides, i.states);
  };
  try {
    const FigureLineage recorded = figure_lineage(store, record);
    return recorded.scale == lineage.scale &&
           recorded.analysis_version == lineage.analysis_version &&
           std::ranges::equal(recorded.inputs, lineage.inputs, {}, key, key);
  } catch (const StoreDamaged&) {
    return false;
  }
}

ReportFigure figure_of(const Store& store, const WantedFigure& wanted, const ReportOptions& options,
                       const std::vector<FigureRecord>& records, ReportData& data) {
  FigureOptions how;
  how.runs = options.runs;
  how.workers = options.workers;
  how.report = options.measured;
  ComputedFigure computed = compute_figure(store, wanted, how);
  const std::string prefix = wanted.experiment.empty() ? "" : wanted.experiment + ".";
  ReportFigure made;
  made.id = prefix + wanted.figure.name;
  made.summary = std::move(computed.summary);
  made.lineage = figure_lineage(store, {wanted.path(), 0, "", computed.lineage});
  const auto newest = std::find_if(
      records.rbegin(), records.rend(),
      [&](const FigureRecord& record) { return is_record_of(store, record, made.lineage); });
  if (newest != records.rend()) made.recorded = *newest;
  for (const FigureTable& table : computed.result.tables) {
    ReportPanel panel{table.name, prefix + table.name, {}, to_csv(table), table.text, "", ""};
    if (!table.chart.series.empty()) panel.chart = chart_json(table);
    try {
      if (!data.interactive && table.text.rows.empty()) panel.drawing = draw(table);
    } catch (const AnalysisError& error) {
      panel.trouble = error.what();
      data.undrawn.insert(fmt::format("figure {}: {}", wanted.path(), error.what()));
    }
    made.panels.push_back(std::move(panel));
  }
  return made;
}

void add_figures(const Store& store, const ReportOptions& options, ReportData& data) {
  const std::vector<FigureRecord> records = figure_records(store);
  WantedFigures wanted = wanted_figures(store, {}, options.runs.experiments);
  std::set<std::string> notes(wanted.unknown.begin(), wanted.unknown.end());
  for (const WantedFigure& figure : wanted.figures) {
    const auto home =
        std::ranges::find(data.experiments, figure.experiment,
                          [](const ReportExperiment& e) { return e.manifest.experiment; });
    const auto leave_out = [&](const std::string& why) {
      notes.insert("figure " + figure.path() + ": " + why);
      if (home != data.experiments.end()) home->unmade.push_back(figure.figure.name);
    };
    try {
      ReportFigure one = figure_of(store, figure, options, records, data);
      const FigureSummary& summary = one.summary;
      data.damage.insert(data.damage.end(), summary.damage.begin(), summary.damage.end());
      notes.insert(summary.pruned.begin(), summary.pruned.end());
      notes.insert(summary.notes.begin(), summary.notes.end());
      if (home != data.experiments.end()) home->figures.push_back(data.figures.size());
      data.figures.push_back(std::move(one));
    } catch (const StoreDamaged& damage) {
      data.damage.emplace_back(damage.what());
      leave_out(damage.what());
    } catch (const UsageError& problem) {
      leave_out(problem.what());
    } catch (const AnalysisError& problem) {
      leave_out(problem.what());
    }
  }
  data.notes.assign(notes.begin(), notes.end());
}

void add_runs(const Store& store, ReportData& data) {
  for (ReportExperiment& experiment : data.experiments) {
    if (auto manifest = find_manifest(store, experiment.manifest.sha256)) {
      experiment.manifest_path = manifest->path;
      data.manifests.try_emplace(experiment.manifest.sha256, std::move(*manifest));
    }
    for (const Stage& run : experiment.runs) {
      add_run_lineage(store, run.id, data.runs);
      // How long a packing takes to settle is not known.
      if (run.kind == name_of(StageKind::prepare)) continue;
      std::vector<Ask> asks = run.asks;
      std::erase_if(
          asks, [&](const Ask& ask) { return ask.experiment != experiment.manifest.experiment; });
      const Outlook look = outlook(run, asks, seen_checkpoints(store, run.id));
      if (!look.done) experiment.checkpoints_left += static_cast<std::size_t>(look.checkpoints);
    }
  }
  for (const ReportFigure& figure : data.figures) {
    for (const ManifestText& manifest : figure.lineage.manifests) {
      data.manifests.try_emplace(manifest.sha256, manifest);
    }
  }
}

/// ReportExperiment::traces.
json traces_of(const RunTable& runs, const RunLineages& lineages) {
  constexpr int significant = 6;
  json all = json::array();
  for (std::size_t k = 0; k < runs.rows.size(); ++k) {
    json& run = all.emplace_back(json::object());
    for (const CheckpointMeasures& checkpoint : runs.histories[k].checkpoints) {
      run["cycle"].push_back(checkpoint.cycle);
      for (const Measure& measure : provider(table_providers().front()).measures) {
        run[std::string(measure.name)].push_back(
            rounded(checkpoint.measures.number(measure.name), significant));
      }
    }
    const std::vector<json>& row = runs.rows[k];
    for (const char* key : {"scale", "variant", "seed"}) run[key] = row[runs.place(key)];
    run["id"] = row[runs.place("run")];
    run["kind"] = lineages.at(run["id"].get<std::string>()).stage.kind;
  }
  return all;
}

/// Adds the results and traces of each experiment's runs. An experiment without them is named in
/// data.notes.
void add_run_tables(const Store& store, const ReportOptions& options, ReportData& data) {
  const MeasureOptions measuring{.workers = options.workers, .report = options.measured};
  for (ReportExperiment& experiment : data.experiments) {
    RunSelection selection = options.runs;
    selection.experiments = {experiment.manifest.experiment};
    try {
      experiment.table = run_table(store, selection, RowPer::run, measuring);
      // Another program may have declared runs since they were listed.
      for (const FigureRun& run : experiment.table.histories)
        add_run_lineage(store, run.run_id, data.runs);
      experiment.traces = traces_of(experiment.table, data.runs);
      for (const std::string& line : experiment.table.damage) {
        if (std::ranges::count(data.damage, line) == 0) data.damage.push_back(line);
      }
    } catch (const std::runtime_error& problem) {
      // No run at this scale, or a record that this version of the program cannot read.
      data.notes.push_back(
          fmt::format("table of runs of {}: {}", experiment.manifest.experiment, problem.what()));
    }
  }
}

}  // namespace

ReportData collect_report(const Store& store, const ReportOptions& options) {
  ReportData data;
  data.head = store.head();
  data.store = std::filesystem::absolute(store.folder()).lexically_normal().filename().string();
  data.program = host_facts().at("build");
  data.interactive = options.interactive && has_front_end();
  select_runs(store, options.runs);  // refuses a name that the store does not have
  data.experiments = experiments_of(store, options.runs.experiments);
  if (data.experiments.empty()) {
    throw NotFound(store.folder().string() +
                   ": the store holds no experiment; `shearcell run` one first");
  }
  std::vector<std::string> names;
  for (const ReportExperiment& experiment : data.experiments)
    names.push_back(experiment.manifest.experiment);
  add_figures(store, options, data);
  add_runs(store, data);
  add_run_tables(store, options, data);
  if (data.interactive) {
    data.packings = collect_packings(store, names, options.runs, options.packings, options.workers,
                                     options.encoded);
    data.notes.insert(data.notes.end(), data.packings.notes.begin(), data.packings.notes.end());
  }
  return data;
}

}  // namespace shearcell
