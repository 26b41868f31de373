// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/draw.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ranges>
#include <set>
#include <utility>

#include "analysis/claims.hpp"
#include "analysis/plot.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// The runs of the figure, each with the states that the figure used. States of earlier checkpoints
/// are included if a measure of the figure is a change between two checkpoints.
nlohmann::json inputs_of(const Store& store, const ComputedFigure& figure,
                         const std::vector<FrameRun>& runs) {
  nlohmann::json list = nlohmann::json::array();
  for (const FrameRun& run : runs) {
    std::vector<CheckpointRecord> used = store.checkpoints(run.stage.id, Listed::and_pruned);
    std::erase_if(used, [&](const CheckpointRecord& c) {
      return !std::ranges::binary_search(run.checkpoints, c.step, {}, &CheckpointMeasures::step) &&
             !figure.earlier.contains(c.sha256);
    });
    const States states = states_of(used);
    list.push_back({{"run", run.stage.id},
                    {"parent", run.stage.parent},
                    {"experiment", run.place.experiment},
                    {"manifest", run.place.manifest},
                    {"variant", run.place.variant},
                    {"seed", run.place.seed},
                    {"cycles", states.cycles},
                    {"state_hash", states.state_hash},
                    {"states_sha256", states.sha256}});
    if (auto given = overrides_of(store, run.stage, run.place, run.ask); !given.is_null()) {
      list.back()["overrides"] = std::move(given);
    }
  }
  return list;
}

/// Records the figure, unless its newest record has the same facts, apart from host and build.
void record(Store& store, const std::string& name, nlohmann::json facts) {
  for (const FigureRecord& known : store.figures()) {
    if (known.name == name && lineage_text(known.provenance) == lineage_text(facts)) return;
  }
  facts["made"] = host_facts();
  store.record("figure/" + name, {events::kFigureGenerated, facts});
}

/// Returns EXPERIMENT/SCALE, such as "drag/desk", or only SCALE for a figure of all experiments.
/// This is the path of the figure's files in the output folder, and the beginning of its record's
/// name. Throws StoreDamaged if a name in the store cannot be a folder name.
std::string place_of(const ComputedFigure& figure) {
  const std::string scale = scale_name(figure.scale);
  for (const auto& [what, name] :
       {std::pair("an experiment", figure.experiment), {"a scale", scale}}) {
    if (name.empty() || is_name(name)) continue;
    throw StoreDamaged(fmt::format(
        "{} of the store is called '{}', which cannot be a folder name; run `verify`", what, name));
  }
  return figure.experiment.empty() ? scale : figure.experiment + "/" + scale;
}

void lay_out(std::vector<Table>& tables, bool wide) {
  char letter = 'a';
  for (Table& table : tables) {
    if (table.chart.series.empty()) continue;
    table.chart.wide = wide;
    if (tables.size() > 1 && letter <= 'z') table.chart.letter = std::string(1, letter++);
  }
}

/// Whether the chart has no point to draw. Checks only the series of runs and of variants. If there
/// are no such series, checks all series.
bool has_no_value(const Table& table) {
  if (table.chart.series.empty()) return table.rows.empty();
  const auto is_own = [](const Series& one) { return one.thin || !one.variant.empty(); };
  const bool none_own = std::ranges::none_of(table.chart.series, is_own);
  return std::ranges::all_of(table.chart.series, [&](const Series& series) {
    return !(none_own || is_own(series)) || drawn_points(table.chart, series).empty();
  });
}

/// The caption: what the panels show, the number of runs, which runs were selected, and what was
/// left out. It is "" if nothing is drawn.
std::string caption_of(const ComputedFigure& figure, const RunSelection& selected) {
  if (figure.tables.empty() || figure.tables.front().chart.series.empty()) return "";
  const auto& runs = figure.runs_by_variant;
  std::vector<std::string> counts;
  std::set<std::size_t> distinct;
  for (const auto& [variant, count] : runs) {
    counts.push_back(fmt::format("{}: {}", variant, count));
    distinct.insert(count);
  }
  if (runs.size() > 1 && distinct.size() == 1) {
    counts = {fmt::format("{} each of {}", *distinct.begin(),
                          runs.size() > 6
                              ? fmt::format("{} variants", runs.size())
                              : fmt::format("{}", fmt::join(runs | std::views::keys, "; ")))};
  }
  // The title of a plot from a user's manifest only repeats the labels of the axes.
  const std::string title = find_figure(figure.name) == nullptr ? "" : ". " + figure.title;
  std::string text = fmt::format(
      "{} Runs: {}.", caption_of(fmt::format("Figure {}{}", figure.name, title), figure.tables),
      fmt::join(counts, "; "));
  const std::string& scale = figure.scale;
  if (figure.experiment.empty()) {
    text += scale.empty() ? "" : " Scale " + scale + ".";
  } else {
    text += " Experiment " + figure.experiment + (scale.empty() ? "" : ", scale " + scale) + ".";
  }
  if (!selected.variants.empty()) {
    text += fmt::format(" Selected: {}.", fmt::join(selected.variants, ", "));
  }
  if (!selected.seeds.empty()) text += fmt::format(" Seeds {}.", fmt::join(selected.seeds, ", "));
  for (const auto& [lines, what] :
       {std::pair(&figure.damage, "damaged"), {&figure.pruned, "pruned"}}) {
    if (lines->empty()) continue;
    text += fmt::format(" Left out: values that need {}.",
                        counted(lines->size(), fmt::format("{} checkpoint", what)));
  }
  if (!figure.why_empty.empty()) text += " " + figure.why_empty;
  if (!figure.notes.empty()) text += fmt::format(" Notes: {}.", fmt::join(figure.notes, "; "));
  return text;
}

std::string verdict_text(const ComputedFigure& figure) {
  nlohmann::json verdict = to_json(figure.verdicts);
  verdict["runs"] = figure.runs_by_variant;
  verdict["figure"] = figure.name;
  if (!figure.experiment.empty()) verdict["experiment"] = figure.experiment;
  verdict["scale"] = scale_name(figure.scale);
  return verdict.dump(1) + "\n";
}

/// Sets Verdict::primary from the key `primary` of the experiment's manifest at this scale. A
/// figure of all experiments uses all manifests. A manifest names a claim by the claim's id, with
/// or without the value of `for_each`. Older manifests name a claim by its statement. If all runs
/// are selected, adds a note for each id CLAIM@VALUE that has no verdict although CLAIM has
/// verdicts for other values.
void mark_primary(const std::vector<RegisteredManifest>& manifests, const RunSelection& selected,
                  ComputedFigure& figure) {
  for (const RegisteredManifest& manifest : manifests) {
    if (!figure.experiment.empty() && manifest.experiment != figure.experiment) continue;
    for (const Scale& scale : scales_of(manifest.content)) {
      if (scale.name != figure.scale && !scale.name.empty()) continue;
      for (const PrimaryClaim& primary : scale.primary) {
        bool named = false, same_claim = false;  // same_claim: ids are equal if @VALUE is ignored
        for (Verdict& verdict : figure.verdicts) {
          const std::string claim = without_value(verdict.id);
          const bool is_it =
              primary.id == verdict.id || primary.id == verdict.text || primary.id == claim;
          verdict.primary |= is_it;
          named |= is_it;
          same_claim |= without_value(primary.id) == claim;
        }
        if (named || !same_claim || !selected.variants.empty() || !selected.seeds.empty()) continue;
        figure.notes.push_back(fmt::format("primary: no verdict has the id {}", primary.id));
      }
    }
  }
}

}  // namespace

ComputedFigure compute_figure(const Store& store, const WantedFigure& wanted,
                              const FigureOptions& options) {
  const Figure& figure = wanted.figure;
  CollectedRuns collected = collect_runs(store, wanted, options.runs, options);
  std::vector<FrameRun>& runs = collected.runs;
  ComputedFigure made;
  made.name = figure.name;
  made.title = figure.title;
  made.experiment = wanted.experiment;
  made.scale = collected.scale;
  made.notes = std::move(collected.notes);
  MeasureOptions measuring = options;
  measuring.also = wanted.also;
  measuring.simulated = figure.simulated;
  std::vector<std::string> providers;  // empty for a table, which needs no measures
  if (figure.form != FigureForm::table) {
    providers = figure.needs;
    providers.insert(providers.begin(), scalars_provider);
  }
  made += measure_runs(store, runs, providers, measuring);
  const std::set<std::string_view> pending = stage_ids(pointers(collected.pending));
  for (const FrameRun& run : runs) {
    made.unmeasured += !pending.contains(run.stage.id) &&
                       std::ranges::any_of(run.checkpoints, [](const auto& one) {
                         return !one.lacking.empty() && one.state != CheckpointState::pruned;
                       });
  }
  std::ranges::for_each(runs, leave_out_unmeasured);
  made.lineage = {{"figure", made.name},
                  {"scale", made.scale},
                  {"analysis_version", analysis_version},
                  {"inputs", inputs_of(store, made, runs)},
                  {"outputs", nlohmann::json::object()}};
  if (!made.experiment.empty()) made.lineage["experiment"] = made.experiment;
  if (!wanted.plots.empty()) made.lineage["plots"] = wanted.plots;
  if (figure.form == FigureForm::groups) {
    require_told_apart(figure.name, pointers(runs), averaged_key(pointers(runs), figure.keys),
                       "make a separate experiment for each value, or define a plot "
                       "in the manifest (`plots`)");
  }
  for (const FrameRun& run : runs) ++made.runs_by_variant[run.name];
  const std::vector<const FrameRun*> counted_once = all_runs_with(nlohmann::json::object(), runs);
  made.runs = counted_once.size();
  std::size_t without_interior = 0;
  for (const FrameRun* run : counted_once) {
    made.checkpoints += run->checkpoints.size();
    without_interior += std::ranges::any_of(run->checkpoints, [](const CheckpointMeasures& one) {
      return one.measures.number("interior_grains") == 0;
    });
  }
  if (without_interior > 0) {
    made.notes.push_back(
        fmt::format("{} of {} had no interior grains (at least 1.5 d from the walls) at some "
                    "checkpoints, so phi and other measures of interior grains have no value there",
                    without_interior, counted(made.runs, "run")));
  }
  static_cast<FigureResult&>(made) = figure.make(collected);
  const bool computed = find_named(computed_figures(), figure.name) != nullptr;
  for (Verdict& verdict : made.verdicts) {
    if (computed && !collected.pending.empty()) {  // other claims do this at each look
      withhold(verdict);
      const bool one = collected.pending.size() == 1;
      add_note(verdict.note, fmt::format("{} {} not ended, or {} not selected",
                                         counted(collected.pending.size(), "planned run"),
                                         one ? "has" : "have", one ? "is" : "are"));
    }
    // The estimate may be missing because runs of the claim were not selected.
    if (verdict.estimate || options.runs.variants.empty()) continue;
    verdict.note =
        fmt::format("only runs with {} are selected{}{}", fmt::join(options.runs.variants, ", "),
                    verdict.note.empty() ? "" : ": ", verdict.note);
  }
  for (Table& table : made.tables) {
    name_run_counts(table);
    if (has_no_value(table)) made.empty.push_back(table.name);
  }
  if (!made.empty.empty() || (made.tables.empty() && made.verdicts.empty())) {
    made.why_empty = fmt::format(
        "Nothing is drawn{}{}: no run has {}.", made.empty.empty() ? "" : " in ",
        fmt::join(made.empty, ", "),
        runs.empty() ? "a checkpoint at the cycles to be shown" : "the values to be shown");
  }
  mark_primary(*collected.manifests, options.runs, made);
  lay_out(made.tables, options.wide);
  made.caption = caption_of(made, options.runs);
  return made;
}

ComputedFigure draw_figure(Store& store, const WantedFigure& wanted, const FigureOptions& options) {
  ComputedFigure made = compute_figure(store, wanted, options);
  const std::string place = place_of(made);
  const std::filesystem::path folder = options.folder / place;
  if (std::error_code failed; !std::filesystem::create_directories(folder, failed) && failed) {
    throw UsageError(fmt::format("{}: cannot create folder: {}. Choose another folder with --out.",
                                 folder.string(), failed.message()));
  }
  for (const Table& table : made.tables) require_own_files(table, folder);
  const std::string base = folder / made.name;
  const auto require = [&](const char* ending, const std::string& start, const std::string& part) {
    require_ours(base + ending, [&](std::string_view beginning) {
      return beginning.starts_with(start) && beginning.find(part) != beginning.npos;
    });
  };
  require(".verdict.json", "{\n \"claims\": [", "");
  require_ours(base + ".verdict.csv", [](std::string_view beginning) {
    return beginning.starts_with("id,claim") || beginning.starts_with("claim");  // older: no `id`
  });
  require(".caption.txt", "Figure " + made.name + ". ", "");
  require(".lineage.json", "{\n \"analysis_version\": ", "\n \"figure\": \"" + made.name + "\"");
  const auto write = [&](const char* ending, const std::string& text) {
    if (text.empty()) {  // an earlier drawing of the figure may have left this file
      std::filesystem::remove(base + ending);
      return;
    }
    made.files.emplace_back(base + ending);
    write_output(made.files.back(), text);
  };
  for (const Table& table : made.tables) {
    made.files.push_back(folder / (table.name + ".csv"));
    write_output(made.files.back(), to_csv(table));
    try {
      const std::filesystem::path svg = draw_svg(table, folder);
      made.files.push_back(svg);
      if (auto pdf = convert_to_pdf(svg)) made.files.push_back(std::move(*pdf));
    } catch (const AnalysisError& error) {
      made.undrawn.emplace_back(error.what());
    }
  }
  write(".caption.txt", made.caption.empty() ? "" : made.caption + "\n");
  const bool claims = !made.verdicts.empty();
  write(".verdict.json", claims ? verdict_text(made) : "");
  write(".verdict.csv", claims ? to_csv(entered_table(made.verdicts)) : "");

  for (const auto& file : made.files) {
    made.lineage["outputs"][file.filename().string()] =
        sha256_hex(read_plain(file, SIZE_MAX - 1).value());
  }
  write(".lineage.json", lineage_text(made.lineage));

  if (options.recorded && (made.undrawn.empty() || !find_program("gnuplot"))) {
    record(store, place + "/" + made.name, made.lineage);
  }
  return made;
}

}  // namespace shearcell
