// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/draw.hpp"

#include <utility>

#include "analysis/error.hpp"
#include "analysis/plot.hpp"
#include "experiments/figures/collect.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/figures/measure.hpp"
#include "experiments/runner/host.hpp"
#include "provenance/derived.hpp"
#include "provenance/io/plain_file.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

struct FigureMeasures {
  Measures measures;
  std::optional<CrystalliteMap> crystallites;
};

std::vector<DerivedMeasure> needed(const Figure& figure) {
  if (figure.needs == FigureNeeds::none) return {};
  std::vector<DerivedMeasure> measures = {scalar_measures()};
  if (figure.needs == FigureNeeds::crystallites) measures.push_back(crystallite_measure());
  return measures;
}

/// Measures of the checkpoints of all runs, one after the other; empty if one cannot be read.
std::vector<std::optional<FigureMeasures>> measures_of(const Store& store, const Figure& figure,
                                                       const std::vector<CollectedRun>& inputs,
                                                       const FigureOptions& options,
                                                       FigureSummary& result) {
  std::vector<CheckpointRecord> records;
  for (const CollectedRun& input : inputs) {
    records.insert(records.end(), input.checkpoints.begin(), input.checkpoints.end());
  }
  MeasuredCheckpoints found = measure_checkpoints(store, records, needed(figure),
                                                  {options.workers, options.fresh, options.report});
  std::vector<std::optional<FigureMeasures>> measured;
  try {
    for (auto& results : found.results) {
      std::optional<FigureMeasures>& one = measured.emplace_back();
      if (!results) continue;
      one.emplace();
      if (!results->empty()) one->measures = read_measures(results->front());
      if (results->size() > 1) one->crystallites = read_crystallite_map(results->at(1));
      results.reset();  // JSON takes more memory than the measures
    }
  } catch (const AnalysisError& problem) {
    throw AnalysisError(std::string(DerivedCache::kFile) + " holds something else (" +
                        problem.what() + "); delete it, or measure again with --fresh");
  }
  result.measured = found.computed;
  result.damage = std::move(found.damage);
  result.pruned = std::move(found.pruned);
  result.changed = std::move(found.changed);
  result.cache_trouble = std::move(found.trouble);
  return measured;
}

std::vector<FigureRun> figure_runs(const std::vector<CollectedRun>& inputs,
                                   std::vector<std::optional<FigureMeasures>> measured) {
  std::vector<FigureRun> runs;
  std::size_t next = 0;
  for (const CollectedRun& input : inputs) {
    FigureRun run{input.run.id,
                  input.membership.experiment,
                  input.membership.variant,
                  input.membership.labels,
                  input.run.resolved.value("parameters", nlohmann::json::object()),
                  input.membership.seed,
                  {}};
    for (const CheckpointRecord& record : input.checkpoints) {
      std::optional<FigureMeasures>& one = measured[next++];
      if (!one) continue;
      CheckpointMeasures& checkpoint = run.checkpoints.emplace_back();
      checkpoint.cycle = record.cycle;
      checkpoint.step = record.step;
      checkpoint.sha256 = record.sha256;
      checkpoint.measures = one->measures;
      checkpoint.crystallites = std::move(one->crystallites);
      const auto stiffness = record.observables.find("stiffness_N_per_m");
      if (stiffness != record.observables.end()) checkpoint.stiffness_N_per_m = stiffness->second;
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

/// The figure's inputs, without anything that depends on the time or the host.
nlohmann::json lineage_of(const FigureSummary& result, const std::vector<CollectedRun>& inputs,
                          const std::vector<FigureRun>& runs) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    nlohmann::json checkpoints = nlohmann::json::array();
    for (const CheckpointMeasures& c : runs[r].checkpoints) checkpoints.push_back(c.sha256);
    list.push_back({{"run", runs[r].run_id},
                    {"parent", inputs[r].run.parent},
                    {"experiment", inputs[r].membership.experiment},
                    {"manifest", inputs[r].membership.manifest},
                    {"variant", runs[r].variant},
                    {"seed", runs[r].seed},
                    {"checkpoints", checkpoints}});
  }
  return {{"figure", result.name},
          {"scale", result.scale},
          {"analysis_version", analysis_version},
          {"inputs", list},
          {"outputs", nlohmann::json::object()}};
}

/// Unless the newest record of the figure says the same, from whatever host.
void record(Store& store, const std::string& name, nlohmann::json facts) {
  for (const FigureRecord& known : store.figures()) {
    if (known.name == name && lineage_text(known.provenance) == lineage_text(facts)) return;
  }
  facts["made"] = host_facts();
  store.record_figure(name, facts);
}

}  // namespace

ComputedFigure compute_figure(const Store& store, const Figure& figure,
                              const FigureOptions& options) {
  ComputedFigure computed;
  FigureSummary& summary = computed.summary;
  const CollectedRuns collected = collect_runs(store, figure, options.scale);
  summary.name = figure.name;
  summary.scale = collected.scale;
  const std::vector<FigureRun> runs =
      figure_runs(collected.runs, measures_of(store, figure, collected.runs, options, summary));
  summary.runs = runs.size();
  for (const FigureRun& run : runs) summary.checkpoints += run.checkpoints.size();
  computed.result = figure.make(runs);
  summary.verdicts = computed.result.verdicts;
  computed.lineage = lineage_of(summary, collected.runs, runs);
  return computed;
}

FigureSummary draw_figure(Store& store, const Figure& figure, const FigureOptions& options) {
  ComputedFigure computed = compute_figure(store, figure, options);
  FigureSummary& result = computed.summary;
  const FigureResult& made = computed.result;
  std::filesystem::create_directories(options.folder);
  for (const FigureTable& table : made.tables) require_own_files(table, options.folder);
  require_ours(options.folder / (result.name + ".verdict.json"), [](std::string_view beginning) {
    return beginning.starts_with("{\n \"claims\": [");
  });
  require_ours(options.folder / (result.name + ".lineage.json"), [&](std::string_view beginning) {
    return beginning.starts_with("{\n \"analysis_version\": ") &&
           beginning.find("\n \"figure\": \"" + result.name + "\"") != beginning.npos;
  });
  const auto write = [&](const char* ending, const std::string& text) {
    result.files.push_back(options.folder / (result.name + ending));
    write_output(result.files.back(), text);
  };
  for (const FigureTable& table : made.tables) {
    result.files.push_back(write_csv(table, options.folder));
    try {
      const std::filesystem::path svg = draw_svg(table, options.folder);
      result.files.push_back(svg);
      if (auto pdf = convert_to_pdf(svg)) result.files.push_back(std::move(*pdf));
    } catch (const AnalysisError& error) {
      result.plot_error = error.what();
    }
  }
  if (!made.verdicts.empty()) {
    nlohmann::json verdict = to_json(made.verdicts);
    verdict["figure"] = result.name;
    verdict["scale"] = result.scale;
    write(".verdict.json", verdict.dump(1) + "\n");
  }

  nlohmann::json& facts = computed.lineage;
  for (const auto& file : result.files) {
    facts["outputs"][file.filename().string()] = sha256_hex_of_file(file);
  }
  write(".lineage.json", lineage_text(facts));

  record(store, result.name, facts);
  return std::move(computed.summary);
}

}  // namespace shearcell
