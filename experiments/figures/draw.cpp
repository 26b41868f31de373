// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/draw.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "analysis/error.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/plot.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// Measures the checkpoints of the runs.
std::vector<FigureRun> figure_runs(const Store& store, const Figure& figure,
                                   const std::vector<CollectedRun>& inputs, MeasureOptions options,
                                   MeasureOutcome& outcome) {
  std::vector<CheckpointRecord> records;  // of one run after the other
  for (const CollectedRun& input : inputs) {
    records.insert(records.end(), input.checkpoints.begin(), input.checkpoints.end());
    options.cadence[input.stage.id] = input.ask.checkpoint_every;
  }
  std::vector<std::string> names;  // none of a table, which is not measured
  if (figure.form != FigureForm::table) {
    names = figure.needs;
    names.insert(names.begin(), "scalars");
  }
  MeasuredCheckpoints found = measure_checkpoints(store, records, names, options);
  std::vector<FigureRun> runs;
  std::size_t k = 0;
  for (const CollectedRun& input : inputs) {
    FigureRun run = unmeasured(input);
    for (const CheckpointRecord& record : input.checkpoints) {
      const std::size_t here = k++;
      if (found.lacks(here, "scalars")) continue;
      CheckpointMeasures& checkpoint = run.checkpoints.emplace_back();
      checkpoint.measures = std::move(found.measures[here]);
      checkpoint.cycle = record.cycle;
      checkpoint.sha256 = record.sha256;
    }
    runs.push_back(std::move(run));
  }
  outcome = std::move(found);
  return runs;
}

/// The checkpoints of the run that the figure was made of, those of earlier cycles from which it
/// measured changes included; by step.
std::vector<CheckpointRecord> used_checkpoints(const Store& store, const FigureSummary& result,
                                               const FigureRun& run) {
  std::set<std::string> used;
  for (const CheckpointMeasures& c : run.checkpoints) used.insert(c.sha256);
  if (const auto earlier = result.earlier.find(run.run_id); earlier != result.earlier.end()) {
    for (const auto& [step, sha256] : earlier->second) used.insert(sha256);
  }
  std::vector<CheckpointRecord> records = store.checkpoints(run.run_id, Listed::and_pruned);
  std::erase_if(records, [&](const CheckpointRecord& c) { return !used.contains(c.sha256); });
  return records;
}

/// The figure's record, without facts that depend on the time or the host.
nlohmann::json lineage_of(const Store& store, const FigureSummary& result,
                          const std::vector<CollectedRun>& inputs,
                          const std::vector<FigureRun>& runs) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const CollectedRun& input = inputs[r];
    const States states = states_of(used_checkpoints(store, result, runs[r]));
    list.push_back({{"run", input.stage.id},
                    {"parent", input.stage.parent},
                    {"experiment", input.ask.experiment},
                    {"manifest", input.ask.manifest},
                    {"variant", input.ask.variant},
                    {"seed", input.ask.seed},
                    {"cycles", states.cycles},
                    {"state_hash", states.state_hash},
                    {"states_sha256", states.sha256}});
    if (auto given = overrides_of(store, input.stage, input.ask); !given.is_null()) {
      list.back()["overrides"] = std::move(given);
    }
  }
  nlohmann::json facts = {{"figure", result.name},
                          {"scale", result.scale},
                          {"analysis_version", analysis_version},
                          {"inputs", list},
                          {"outputs", nlohmann::json::object()}};
  if (!result.experiment.empty()) facts["experiment"] = result.experiment;
  return facts;
}

/// Records the figure, unless its newest record says the same (host and build aside).
void record(Store& store, const std::string& name, nlohmann::json facts) {
  for (const FigureRecord& known : store.figures()) {
    if (known.name == name && lineage_text(known.provenance) == lineage_text(facts)) return;
  }
  facts["made"] = host_facts();
  store.record_figure(name, facts);
}

/// "drag/desk", or "desk" for a figure of all experiments: the path of its files in the folder for
/// figures, and of its record. Checks both names, since the store is not trusted.
std::string place_of(const FigureSummary& figure) {
  const std::string scale = scale_name(figure.scale);
  for (const auto& [what, name] :
       {std::pair("an experiment", figure.experiment), {"a scale", scale}}) {
    if (name.empty() || is_name(name)) continue;
    throw StoreDamaged(fmt::format(
        "{} of the store is called '{}', which cannot name a folder; run `verify`", what, name));
  }
  return figure.experiment.empty() ? scale : figure.experiment + "/" + scale;
}

/// Gives the panels of a figure letters.
void lay_out(std::vector<FigureTable>& tables, bool wide) {
  char letter = 'a';
  for (FigureTable& table : tables) {
    if (table.chart.series.empty()) continue;
    table.chart.wide = wide;
    if (tables.size() > 1 && letter <= 'z') table.chart.letter = std::string(1, letter++);
  }
}

/// Whether the runs have no value that the table can draw. Series that are neither traces nor
/// columns of the table hold published points.
bool has_no_value(const FigureTable& table) {
  if (table.chart.series.empty()) return table.rows.empty();
  const auto is_drawn = [&](const ChartPoint& point) { return is_on_log_axes(table.chart, point); };
  // Points that are stated beside columns are published ones.
  const auto has_columns = [](const Series& one) { return one.thin || !one.columns.x.empty(); };
  const bool all_stated = std::ranges::none_of(table.chart.series, has_columns);
  return std::ranges::all_of(table.chart.series, [&](const Series& series) {
    return !(all_stated || has_columns(series)) ||
           std::ranges::none_of(points_of(table, series), is_drawn);
  });
}

/// Also says which runs were selected and what was left out.
std::string caption(const FigureSummary& summary, const std::map<std::string, std::size_t>& runs,
                    const std::vector<FigureTable>& tables, const RunSelection& selected) {
  std::vector<std::string> variants, counts;
  std::set<std::size_t> distinct;
  for (const auto& [variant, count] : runs) {
    variants.push_back(variant);
    counts.push_back(fmt::format("{}: {}", variant, count));
    distinct.insert(count);
  }
  if (runs.size() > 1 && distinct.size() == 1) {
    counts = {fmt::format("{} each of {}", *distinct.begin(),
                          runs.size() > 6 ? fmt::format("{} variants", runs.size())
                                          : fmt::format("{}", fmt::join(variants, "; ")))};
  }
  // The title of an own plot says what its axes say.
  const std::string title = find_figure(summary.name) == nullptr ? "" : ". " + summary.title;
  std::string text = fmt::format(
      "{} Runs: {}. {}cale {}.",
      caption_of(fmt::format("Figure {}{}", summary.name, title), tables), fmt::join(counts, "; "),
      summary.experiment.empty() ? "S" : "Experiment " + summary.experiment + ", s",
      scale_name(summary.scale));
  if (!selected.variants.empty()) {
    text += fmt::format(" Selected: {}.", fmt::join(selected.variants, ", "));
  }
  if (!selected.seeds.empty()) text += fmt::format(" Seeds {}.", fmt::join(selected.seeds, ", "));
  for (const auto& [lines, what] :
       {std::pair(&summary.damage, "damaged"), {&summary.pruned, "pruned"}}) {
    if (lines->empty()) continue;
    text += fmt::format(" Left out: {}, {}.", counted(lines->size(), "checkpoint"), what);
  }
  if (!summary.notes.empty()) text += fmt::format(" Notes: {}.", fmt::join(summary.notes, "; "));
  return text;
}

std::string verdict_text(const ComputedFigure& computed) {
  const FigureSummary& summary = computed.summary;
  nlohmann::json verdict = to_json(computed.result.verdicts);
  verdict["runs"] = computed.runs_by_variant;
  verdict["figure"] = summary.name;
  if (!summary.experiment.empty()) verdict["experiment"] = summary.experiment;
  verdict["scale"] = summary.scale;
  return verdict.dump(1) + "\n";
}

/// The figure's title; if it is about other parameters than the runs differ in, it names those too.
std::string title_of(const Figure& figure, const std::vector<FigureRun>& runs) {
  const std::vector<std::string> varied = varied_keys(runs);
  const bool of_its_keys = std::ranges::any_of(
      varied, [&](const std::string& key) { return std::ranges::count(figure.keys, key) > 0; });
  if (figure.keys.empty() || varied.empty() || of_its_keys) return figure.title;
  return fmt::format("{} (these runs differ in {})", figure.title, fmt::join(varied, ", "));
}

/// Sets Verdict::primary as the newest manifest states at the scale, of a figure of all experiments
/// as any of them does.
void mark_primary(const Store& store, const FigureSummary& summary,
                  std::vector<Verdict>& verdicts) {
  for (const RegisteredManifest& registered : newest_manifests(store)) {
    if (!summary.experiment.empty() && registered.experiment != summary.experiment) continue;
    const std::optional<Manifest> manifest = parsed(registered);
    if (!manifest) continue;
    for (const Scale& scale : scales_of(*manifest)) {
      if (scale.name != summary.scale) continue;
      for (Verdict& verdict : verdicts) {
        if (std::ranges::count(scale.primary, verdict.claim) > 0) verdict.primary = true;
      }
    }
  }
}

void add_new(const std::vector<std::string>& from, std::vector<std::string>& to) {
  for (const std::string& line : from) {
    if (std::ranges::count(to, line) == 0) to.push_back(line);
  }
}

/// The figure that is made of others, which the manifests of the store list: those that have runs
/// at its scale and can be made.
ComputedFigure compute_summary(const Store& store, const WantedFigure& wanted,
                               const FigureOptions& options) {
  ComputedFigure computed;
  FigureSummary& summary = computed.summary;
  CollectedRuns collected = collect_runs(store, wanted, options.runs, options);
  summary.name = wanted.figure.name;
  summary.title = wanted.figure.title;
  summary.scale = collected.scale;
  summary.notes = std::move(collected.notes);
  FigureOptions of_part = options;
  of_part.runs.scales = {scale_name(collected.scale)};
  const std::vector<std::string>& experiments = options.runs.experiments;
  std::vector<FigurePart> parts;
  std::set<nlohmann::json> inputs;
  std::set<std::pair<std::string, std::string>> runs;  // of each experiment
  for (const WantedFigure& part : wanted_figures(store, summary_parts()).figures) {
    if (!experiments.empty() && std::ranges::count(experiments, part.experiment) == 0) continue;
    try {
      ComputedFigure one = compute_figure(store, part, of_part);
      for (const nlohmann::json& input : one.lineage.at("inputs")) {
        inputs.insert(input);
        if (runs.emplace(part.experiment, input.at("run")).second) {
          ++computed.runs_by_variant[part.experiment];
        }
      }
      summary.checkpoints += one.summary.checkpoints;
      summary.measured += one.summary.measured;
      summary.cached += one.summary.cached;
      add_new(one.summary.damage, summary.damage);
      add_new(one.summary.pruned, summary.pruned);
      parts.push_back({part.experiment, part.figure.name, std::move(one.result)});
    } catch (const NotFound&) {
      continue;  // no run at this scale
    } catch (const UsageError& problem) {
      summary.notes.push_back(fmt::format("left out: {}: {}", part.path(), problem.what()));
    }
  }
  summary.runs = runs.size();
  computed.result = figure_summary(parts);
  mark_primary(store, summary, computed.result.verdicts);
  summary.verdicts = computed.result.verdicts;
  computed.lineage = {{"figure", summary.name},
                      {"scale", summary.scale},
                      {"analysis_version", analysis_version},
                      {"inputs", inputs},
                      {"outputs", nlohmann::json::object()}};
  return computed;
}

}  // namespace

ComputedFigure compute_figure(const Store& store, const WantedFigure& wanted,
                              const FigureOptions& options) {
  const Figure& figure = wanted.figure;
  if (!figure.make) return compute_summary(store, wanted, options);
  ComputedFigure computed;
  FigureSummary& summary = computed.summary;
  CollectedRuns collected = collect_runs(store, wanted, options.runs, options);
  summary.name = figure.name;
  summary.experiment = wanted.experiment;
  summary.notes = std::move(collected.notes);
  summary.scale = collected.scale;
  MeasureOptions measuring = options;
  measuring.also = wanted.also;
  measuring.simulated = figure.simulated;
  const std::vector<FigureRun> runs =
      figure_runs(store, figure, collected.runs, measuring, summary);
  if (figure.form == FigureForm::groups) {
    require_told_apart(
        figure.name, runs, figure.keys,
        "give each an experiment of its own, or state a plot in the manifest (`plots`)");
  }
  summary.title = title_of(figure, runs);
  summary.runs = runs.size();
  for (const FigureRun& run : runs) {
    summary.checkpoints += run.checkpoints.size();
    ++computed.runs_by_variant[run.name];
  }
  computed.result = figure.make(runs);
  for (Verdict& verdict : computed.result.verdicts) {
    // The runs that it compares may be among those that were not selected.
    if (verdict.estimate || options.runs.variants.empty()) continue;
    verdict.note =
        fmt::format("only runs with {} are selected{}{}", fmt::join(options.runs.variants, ", "),
                    verdict.note.empty() ? "" : ": ", verdict.note);
  }
  mark_primary(store, summary, computed.result.verdicts);
  for (FigureTable& table : computed.result.tables) name_run_counts(table);
  summary.verdicts = computed.result.verdicts;
  for (const FigureTable& table : computed.result.tables) {
    if (has_no_value(table)) summary.empty.push_back(table.name);
  }
  computed.lineage = lineage_of(store, summary, collected.runs, runs);
  return computed;
}

FigureSummary draw_figure(Store& store, const WantedFigure& wanted, const FigureOptions& options) {
  ComputedFigure computed = compute_figure(store, wanted, options);
  FigureSummary& result = computed.summary;
  const std::string place = place_of(result);
  const std::filesystem::path folder = options.folder / place;
  FigureResult& made = computed.result;
  lay_out(made.tables, options.wide);
  if (std::error_code failed; !std::filesystem::create_directories(folder, failed) && failed) {
    throw UsageError(fmt::format("{}: cannot make this folder: {}. Name another with --out.",
                                 folder.string(), failed.message()));
  }
  for (const FigureTable& table : made.tables) require_own_files(table, folder);
  const std::string base = folder / result.name;
  const auto require = [&](const char* ending, const std::string& start, const std::string& part) {
    require_ours(base + ending, [&](std::string_view beginning) {
      return beginning.starts_with(start) && beginning.find(part) != beginning.npos;
    });
  };
  require(".verdict.json", "{\n \"claims\": [", "");
  require(".verdict.csv", "claim,", "");
  require(".caption.txt", "Figure " + result.name + ". ", "");
  require(".lineage.json", "{\n \"analysis_version\": ", "\n \"figure\": \"" + result.name + "\"");
  const auto write = [&](const char* ending, const std::string& text) {
    if (text.empty()) {  // delete that of an older figure
      std::filesystem::remove(base + ending);
      return;
    }
    result.files.emplace_back(base + ending);
    write_output(result.files.back(), text);
  };
  for (const FigureTable& table : made.tables) {
    result.files.push_back(write_csv(table, folder));
    try {
      const std::filesystem::path svg = draw_svg(table, folder);
      result.files.push_back(svg);
      if (auto pdf = convert_to_pdf(svg)) result.files.push_back(std::move(*pdf));
    } catch (const AnalysisError& error) {
      result.undrawn.emplace_back(error.what());
    }
  }
  const bool drawn = !made.tables.empty() && !made.tables.front().chart.series.empty();
  write(".caption.txt",
        drawn ? caption(result, computed.runs_by_variant, made.tables, options.runs) + "\n" : "");
  const bool claims = !made.verdicts.empty();
  write(".verdict.json", claims ? verdict_text(computed) : "");
  write(".verdict.csv", claims ? to_csv(entered_table(made.verdicts)) : "");

  nlohmann::json& facts = computed.lineage;
  for (const auto& file : result.files) {
    facts["outputs"][file.filename().string()] = sha256_hex_of_file(file);
  }
  write(".lineage.json", lineage_text(facts));

  if (result.undrawn.empty() || !find_program("gnuplot")) {
    record(store, place + "/" + result.name, facts);
  }
  return std::move(computed.summary);
}

}  // namespace shearcell
