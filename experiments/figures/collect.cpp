// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <ranges>
#include <set>
#include <utility>

#include "core/named.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/outlook.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/lineage.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// Returns the id of the stage that settled the packing of `stage`. If the packing was made from a
/// file of grains, returns the SHA-256 of the file. Returns "" for a stage without a packing.
std::string packing_before(const Store& store, const Stage& stage) {
  if (stage.parent.empty()) return "";
  const Stage first = chain_of(store, stage.parent).front();
  const nlohmann::json file = member_of(member_of(first.resolved, "start"), "file");
  return file.is_string() ? file.get<std::string>() : first.id;
}

std::string unknown_name(const char* what, const std::string& name,
                         const std::vector<std::string_view>& known) {
  return fmt::format("there is no {} {}; {}", what, name, did_you_mean(name, known));
}

/// Sets FrameRun::core_time_s. Adds a note if different processors computed the runs.
void add_core_times(const Store& store, CollectedRuns& collected) {
  std::set<std::string> processors;
  for (FrameRun& run : collected.runs) {
    ComputingTime time = computing_time(store, run.stage.id, run.end);
    run.core_time_s = time.core_seconds;
    processors.merge(time.processors);
  }
  if (processors.size() < 2) return;
  collected.notes.push_back(
      fmt::format("core times were measured on different processors: {}", some_of(processors)));
}

/// Adds to each run the checkpoints that the figure needs, up to the end of the run. Removes runs
/// that have none of these checkpoints. Adds notes on removed runs, on unfinished runs, and on
/// checkpoints that the manifest asks for and the run did not record. A FigureForm::table needs
/// only the last checkpoint of each run; for such a figure, no run is removed and no note is added.
void add_checkpoints(const Store& store, const Figure& figure, const MeasureOptions& measuring,
                     CollectedRuns& collected) {
  const auto [first, last] =
      figure.within.value_or(std::array<std::uint64_t, 2>{0, StoreLimits::cycles});
  std::set<std::string> not_begun, never, going_on;
  struct Lack {
    std::size_t checkpoints = 0;
    std::set<std::string> runs;
  };
  std::map<bool, Lack> lacks;  // key: whether LAMMPS computed the runs
  const bool last_only = figure.form == FigureForm::table;
  for (FrameRun& run : collected.runs) {
    run.end = last_only ? static_cast<double>(run.ask.target_cycles)
                        : end_for(store, run.stage, run.ask, measuring);
    const double end = std::min(run.end, static_cast<double>(last));
    Ask ask = run.ask;
    if (!figure.within) ask.checkpoint_phases.clear();
    const AskedCheckpoints asked =
        asked_checkpoints(run.stage, {&ask, 1}, store.checkpoints(run.stage.id, Listed::and_pruned),
                          static_cast<double>(first), end);
    for (const CheckpointRecord& record : asked.made) {
      if (!last_only || &record == &asked.made.back()) run.checkpoints.push_back({record});
    }
    if (last_only) continue;
    const bool completed = run.stage.state == StageState::completed;
    const bool failed = has_failed(store, run.stage);
    const std::string name =
        fmt::format("{} seed {}{}", run.name, run.place.seed, failed ? " (failed)" : "");
    if (asked.made.empty()) {
      const bool can_be_made = !figure.within || run.stage.kind != name_of(StageKind::shear) ||
                               !asked.missing.empty() || (!completed && asked.to_come > 0);
      (can_be_made ? not_begun : never).insert(name);
    } else if (!completed && asked.made.back().cycle < end) {
      going_on.insert(name);
    }
    if (!failed && not_begun.contains(name) + going_on.contains(name) > 0) {
      collected.pending.push_back(run);
    }
    if (asked.made.empty() || asked.missing.empty()) continue;
    Lack& lack = lacks[engine_of(run.stage.resolved) == EngineKind::lammps];
    if (lack.runs.insert(run.stage.id.substr(0, 8)).second) {
      lack.checkpoints += asked.missing.size();
    }
  }
  if (last_only) return;
  std::erase_if(collected.runs, [](const FrameRun& run) { return run.checkpoints.empty(); });
  for (const auto* names : {&not_begun, &never}) {
    if (names->empty()) continue;
    const std::string which = !figure.within  ? ""
                              : first == last ? fmt::format(" at cycle {}", first)
                                              : fmt::format(" in cycles {} to {}", first, last);
    collected.notes.push_back(fmt::format("left out: {} without a checkpoint{}{}: {}",
                                          counted(names->size(), "run"), which,
                                          names == &never ? "" : " yet", some_of(*names)));
  }
  if (!going_on.empty()) {
    collected.notes.push_back(
        fmt::format("unfinished runs, shown only up to their last checkpoints: {}: {}",
                    counted(going_on.size(), "run"), some_of(going_on)));
  }
  if (std::ranges::count(figure.needs, cost_provider) > 0) add_core_times(store, collected);
  for (const auto& [of_lammps, lack] : lacks) {
    collected.notes.push_back(fmt::format(
        "missing: {} that the manifest asks for (runs {}); {}",
        counted(lack.checkpoints, "checkpoint"), some_of(lack.runs),
        of_lammps
            ? "`run` and `resume` cannot add these checkpoints, because LAMMPS computed the runs "
              "and cannot repeat them bit for bit"
            : "`shearcell run` with the manifest, or `shearcell resume RUN`, computes them"));
  }
}

void name_variants(const std::vector<VariantLabel>& labels, const std::string& experiment,
                   CollectedRuns& collected) {
  std::vector<nlohmann::json> variants;
  for (const FrameRun& run : collected.runs) {
    if (run.place.experiment == experiment) variants.push_back(run.place.swept);
  }
  const auto names = variant_names(variants, labels);
  for (FrameRun& run : collected.runs) {
    if (run.place.experiment != experiment) continue;
    run.name = names.at(run.place.swept);
    run.named = std::ranges::any_of(
        labels, [&](const VariantLabel& label) { return selects(label, run.place.swept); });
  }
}

/// Adds to Frame::seeds the seeds of the manifest, and to Frame::pending the planned runs that are
/// not among the collected runs. If all runs of the experiment were added by `run --engine`, they
/// count as the planned runs. Sets Frame::looks, unless the figure combines experiments: their
/// looks may differ. Does nothing if the sweep has more variants than ManifestLimits::runs.
void add_planned(const RegisteredManifest& manifest, bool combined, CollectedRuns& collected) {
  const bool all_of_engine = std::ranges::all_of(collected.runs, [&](const FrameRun& run) {
    return run.place.experiment != manifest.experiment || run.place.swept.contains("engine");
  });
  std::set<std::pair<std::uint64_t, nlohmann::json>> declared;
  for (const FrameRun& run : collected.runs) {
    if (run.place.experiment != manifest.experiment) continue;
    nlohmann::json swept = run.place.swept;
    if (all_of_engine) swept.erase("engine");
    declared.emplace(run.place.seed, std::move(swept));
  }
  for (const Scale& scale : scales_of(manifest.content)) {
    if (scale.name != collected.scale || variant_count(scale.sweep) > ManifestLimits::runs)
      continue;
    const std::vector<std::uint64_t>& seeds = scale.seeds.values;
    if (!combined) collected.looks = scale.looks;
    std::ranges::copy_if(seeds, std::back_inserter(collected.seeds), [&](std::uint64_t seed) {
      return std::ranges::count(collected.seeds, seed) == 0;
    });
    const std::vector<Variant> variants = variants_of(scale);
    const std::vector<FrameRun> runs = planned_runs(manifest.content, scale, variants);
    for (std::size_t k = 0; k < variants.size(); ++k) {
      for (const std::uint64_t seed : seeds | std::views::take(variants[k].seeds)) {
        if (declared.contains({seed, runs[k].place.swept})) continue;
        FrameRun& run = collected.pending.emplace_back(runs[k]);
        run.place.seed = seed;
        run.stage.id += fmt::format(" seed {}", seed);
      }
    }
  }
}

/// Adds the name of the experiment to the swept values, to the variant and to the name of the run.
void add_experiment(FrameRun& run) {
  const std::string& experiment = run.place.experiment;
  run.place.swept["experiment"] = experiment;
  run.place.variant = fmt::format("experiment={}{}{}", experiment,
                                  run.place.variant.empty() ? "" : ",", run.place.variant);
  run.name = fmt::format("{}{}{}", experiment, run.name.empty() ? "" : ": ", run.name);
}

/// Puts the runs of several experiments in the order of `experiments`. A run that they share occurs
/// once for each of them (see all_runs_with()). Adds a note on each experiment without runs.
void join(const std::vector<std::string>& experiments, CollectedRuns& collected) {
  std::vector<FrameRun> joined;
  for (const std::string& experiment : experiments) {
    const std::size_t before = joined.size();
    std::ranges::copy_if(collected.runs, std::back_inserter(joined),
                         [&](const FrameRun& run) { return run.place.experiment == experiment; });
    if (joined.size() > before) continue;
    collected.notes.push_back("left out: experiment without runs: " + experiment);
  }
  collected.runs = std::move(joined);
  std::ranges::for_each(collected.runs, add_experiment);
  std::ranges::for_each(collected.pending, add_experiment);
}

/// Returns the selected runs of the figure's experiments, including runs of older manifest
/// versions. Throws NotFound if these experiments have no selected run.
std::vector<Run> runs_of(const Store& store, const WantedFigure& wanted,
                         const RunSelection& selection) {
  std::vector<Run> found = select_runs(store, selection);
  std::erase_if(found, [&](const Run& s) {
    if (!wanted.figure.of.empty()) {
      return std::ranges::count(wanted.figure.of, s.place.experiment) == 0;
    }
    return !wanted.experiment.empty() && s.place.experiment != wanted.experiment;
  });
  if (found.empty()) {
    throw NotFound(fmt::format(
        "no selected run belongs to figure {}; `shearcell status` lists the runs of the "
        "store, and `shearcell run` computes the runs of a manifest",
        wanted.path()));
  }
  return found;
}

/// The scale of the run that was declared last. Considers only runs of `manifests`, which are the
/// newest versions. If there are no such runs, considers all runs.
std::string last_scale(const std::vector<Run>& runs,
                       const std::vector<RegisteredManifest>& manifests) {
  const auto is_newest = [&](const Run& run) {
    return std::ranges::count(manifests, run.place.manifest, &RegisteredManifest::sha256) > 0;
  };
  const auto last = std::ranges::find_if(runs.rbegin(), runs.rend(), is_newest);
  return (last == runs.rend() ? runs.back() : *last).place.scale;
}

bool is_across(const Figure& figure) {
  return figure.form == FigureForm::table || !figure.of.empty();
}

void share_needs(std::vector<WantedFigure>& figures) {
  std::map<std::string, std::set<std::string>> needs;  // by experiment
  for (const WantedFigure& wanted : figures) {
    for (const std::string& name : wanted.figure.needs) {
      const Provider& one = provider(name);
      const bool analyses = one.from == ComputedFrom::checkpoint && one.cycles_back == 0;
      if (analyses) needs[wanted.experiment].insert(name);
    }
  }
  for (WantedFigure& wanted : figures) {
    wanted.also.assign(needs[wanted.experiment].begin(), needs[wanted.experiment].end());
  }
}

ReadManifests read_manifests(const Store& store) {
  return std::make_shared<const std::vector<RegisteredManifest>>(newest_manifests(store));
}

}  // namespace

std::vector<FrameRun> frame_runs(std::vector<Run> selected, std::vector<std::string>& notes) {
  NewestRuns newest = newest_runs(std::move(selected));
  std::ranges::move(newest.notes, std::back_inserter(notes));
  std::vector<FrameRun> runs;
  for (Run& run : newest.runs) {
    FrameRun& made = runs.emplace_back(FrameRun{std::move(run)});
    made.parameters = effective_parameters(made.stage.resolved);
    made.parameters.emplace("pressure_at", name_of(PressureAt::top));  // absent without effect
  }
  return runs;
}

void leave_out_unmeasured(FrameRun& run) {
  std::erase_if(run.checkpoints, [](const CheckpointMeasures& one) {
    return std::ranges::count(one.lacking, scalars_provider) > 0;
  });
  run.end = std::min(run.end, run.stage.cycle);
}

MeasureOutcome measure_runs(const Store& store, std::vector<FrameRun>& runs,
                            std::span<const std::string> providers, const MeasureOptions& options) {
  std::vector<ToMeasure> chosen;
  for (FrameRun& run : runs) {
    for (auto& one : run.checkpoints) chosen.push_back({&one, run.ask.checkpoint_every});
  }
  return measure_checkpoints(store, chosen, providers, options);
}

std::string WantedFigure::path() const {
  return experiment.empty() ? figure.name : experiment + "/" + figure.name;
}

WantedFigures wanted_figures(const Store& store, const std::vector<std::string>& names,
                             const std::vector<std::string>& experiments) {
  const ReadManifests read = read_manifests(store);
  const std::vector<RegisteredManifest>& manifests = *read;
  std::vector<std::string_view> registered;
  for (const RegisteredManifest& manifest : manifests) registered.emplace_back(manifest.experiment);
  for (const std::string& experiment : experiments) {
    if (std::ranges::count(registered, experiment) == 0) {
      throw NotFound(unknown_name("experiment", experiment, registered));
    }
  }
  const auto among = [](const auto& some, const std::string& name) {
    return some.empty() || std::ranges::count(some, name) > 0;
  };
  const auto asked = [&](const std::string& name) { return among(names, name); };
  const bool named = !experiments.empty() && !names.empty();
  WantedFigures wanted;
  const std::vector<std::string_view> supplement = names_of(all_figures());
  std::set<std::string> known(supplement.begin(), supplement.end()), reported;
  for (const RegisteredManifest& manifest : manifests) {
    if (!among(experiments, manifest.experiment)) continue;
    std::vector<Figure> stated = stated_figures(manifest.content);
    for (const Figure& figure : all_figures()) {
      const bool lists = std::ranges::count(manifest.figures, figure.name) > 0;
      if (is_across(figure) || !asked(figure.name) || !(named || lists)) continue;
      if (find_named(std::span<const Figure>(stated), figure.name) != nullptr) continue;
      WantedFigure& made = wanted.figures.emplace_back(WantedFigure{figure, manifest.experiment});
      if (find_named(computed_figures(), figure.name) != nullptr) continue;
      made.plots =
          fmt::format("drawn by the plots of shearcell {}; the manifest {}",
                      host_facts().at("build").at("version").get<std::string>(),
                      lists ? "lists " + figure.name + " only" : "does not name " + figure.name);
    }
    for (Figure& figure : stated) {
      known.insert(figure.name);
      if (asked(figure.name)) wanted.figures.push_back({std::move(figure), manifest.experiment});
    }
    for (const std::string& name : manifest.figures) {
      if (!names.empty() || find_figure(name) != nullptr || !reported.insert(name).second) continue;
      wanted.unknown.push_back("experiment " + manifest.experiment + ": " +
                               unknown_name("figure", name, supplement));
    }
  }
  for (const Figure& figure : all_figures()) {
    if (!is_across(figure) || manifests.empty() || !asked(figure.name)) continue;
    // Without `names`, table1 is drawn if a manifest lists figures of the supplement. A figure that
    // compares experiments is drawn if at least two of these experiments are registered.
    const auto lists_any = [](const RegisteredManifest& one) { return !one.figures.empty(); };
    const auto registers = [&](const std::string& of) { return among(registered, of); };
    const bool has_runs = figure.of.empty() ? std::ranges::any_of(manifests, lists_any)
                                            : std::ranges::count_if(figure.of, registers) > 1;
    const bool drawn = !names.empty() || (has_runs && experiments.empty());
    if (drawn) wanted.figures.push_back({figure, ""});
  }
  for (const std::string& name : names) {
    if (!known.contains(name))
      throw NotFound(unknown_name("figure", name, {known.begin(), known.end()}));
  }
  share_needs(wanted.figures);
  for (WantedFigure& figure : wanted.figures) figure.manifests = read;
  return wanted;
}

std::string leave_out_unselected(const Store& store, const RunSelection& runs,
                                 std::vector<WantedFigure>& figures) {
  std::set<std::string> selected, others;
  for (const Run& run : select_runs(store, runs)) selected.insert(run.place.experiment);
  for (const WantedFigure& figure : figures) {
    const std::string& name = figure.experiment;
    const auto is_selected = [&](const std::string& one) { return selected.contains(one); };
    const bool any = std::ranges::any_of(figure.figure.of, is_selected) || is_selected(name);
    if (!name.empty() && !any) others.insert(name);
  }
  if (selected.empty() || others.empty()) return "";
  std::erase_if(figures, [&](const auto& figure) { return others.contains(figure.experiment); });
  return "left out: experiments without a selected run: " + some_of(others);
}

CollectedRuns collect_runs(const Store& store, const WantedFigure& wanted,
                           const RunSelection& selection, const MeasureOptions& measuring) {
  CollectedRuns collected;
  collected.manifests = wanted.manifests ? wanted.manifests : read_manifests(store);
  const std::vector<RegisteredManifest>& manifests = *collected.manifests;
  std::vector<Run> selected = runs_of(store, wanted, selection);
  collected.scale = last_scale(selected, manifests);
  std::set<std::string> elsewhere;  // experiments without a run at this scale
  for (const Run& one : selected) elsewhere.insert(one.place.experiment);
  std::erase_if(selected, [&](const Run& s) { return s.place.scale != collected.scale; });
  for (const Run& one : selected) elsewhere.erase(one.place.experiment);
  if (!elsewhere.empty()) {
    collected.notes.push_back(fmt::format("left out: experiments without a run at scale {}: {}",
                                          scale_name(collected.scale), some_of(elsewhere)));
  }
  collected.runs = frame_runs(std::move(selected), collected.notes);
  if (collected.runs.empty()) {
    throw NotFound(fmt::format(
        "the runs selected for figure {} belong to an older version of the manifest; `shearcell "
        "run` with that version makes it the newest version again (this computes nothing)",
        wanted.path()));
  }
  std::map<std::string, std::string> packings;  // by id of the parent stage
  for (FrameRun& run : collected.runs) {
    const auto [packing, fresh] = packings.try_emplace(run.stage.parent);
    if (fresh) packing->second = packing_before(store, run.stage);
    run.packing = packing->second;
  }
  const bool measured = wanted.figure.form != FigureForm::table;
  if (measured) {
    std::set<std::string> experiments;
    for (const FrameRun& run : collected.runs) experiments.insert(run.place.experiment);
    for (const RegisteredManifest& manifest : manifests) {
      if (!experiments.contains(manifest.experiment)) continue;
      name_variants(manifest.content.labels, manifest.experiment, collected);
      add_planned(manifest, !wanted.figure.of.empty(), collected);
    }
    if (!wanted.figure.of.empty()) join(wanted.figure.of, collected);
    collected.variants = swept_of(pointers(collected.runs));
    std::erase_if(collected.runs, [&](const FrameRun& run) {
      return wanted.figure.uses && !wanted.figure.uses(run);
    });
  } else {
    std::set<std::pair<std::string, std::string>> known;
    std::erase_if(collected.runs, [&](const FrameRun& run) {
      return !known.emplace(run.place.experiment, run.stage.id).second;
    });
  }
  add_checkpoints(store, wanted.figure, measuring, collected);
  for (const FrameRun& run : collected.runs) {
    if (member_of(run.stage.resolved, "parameters").is_object()) continue;
    throw StoreDamaged(fmt::format(
        "the record of run {:.8} has no parameters; `shearcell verify` reports all damage",
        run.stage.id));
  }
  return collected;
}

}  // namespace shearcell
