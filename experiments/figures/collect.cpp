// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "core/named.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/lineage.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

constexpr std::array<std::uint64_t, 2> whole_run = {0, StoreLimits::cycles};

/// What the experiment asks of the run, without phases of a cycle unless the figure names cycles.
Ask ask_for(const Figure& figure, const FrameRun& run) {
  Ask ask = run.ask;
  if (!figure.within) ask.checkpoint_phases.clear();
  return ask;
}

/// The first cycle that the figure takes.
double first_cycle(const Figure& figure) {
  return static_cast<double>(figure.within.value_or(whole_run)[0]);
}

/// The last cycle that the figure takes of the run.
double last_cycle(const Figure& figure, const FrameRun& run) {
  return std::min(run.end, static_cast<double>(figure.within.value_or(whole_run)[1]));
}

/// Adds the checkpoints that the figure takes, up to the run's end. A figure that measures nothing
/// takes only the last one.
void add_checkpoints(const Store& store, const Figure& figure, FrameRun& run) {
  const Ask ask = ask_for(figure, run);
  const std::vector<CheckpointRecord> found =
      checkpoints_for(store, run.stage, {&ask, 1}, first_cycle(figure), last_cycle(figure, run));
  const bool last_only = figure.form == FigureForm::table;
  for (const CheckpointRecord& record : found) {
    if (!last_only || &record == &found.back()) run.checkpoints.push_back({record});
  }
}

/// The number of checkpoints that the figure asks for, before the run's last one, and that are
/// missing.
std::size_t missing_for(const Figure& figure, const FrameRun& run) {
  std::size_t missing = 0;
  for (const std::uint64_t step :
       asked_steps(run.stage, ask_for(figure, run), first_cycle(figure), last_cycle(figure, run))) {
    const bool made =
        std::ranges::binary_search(run.checkpoints, step, {}, &CheckpointMeasures::step);
    missing += step < run.stage.step && !made ? 1 : 0;
  }
  return missing;
}

/// Notes how many checkpoints are missing up to the end of the runs: a manifest may state a denser
/// cadence than that of the runs.
void note_never_made(const Figure& figure, CollectedRuns& collected) {
  struct Lack {
    std::size_t checkpoints = 0;
    std::set<std::string> runs;
  };
  std::map<bool, Lack> lacks;  // of our runs, and of those of LAMMPS
  for (const FrameRun& run : collected.runs) {
    const std::size_t missing = missing_for(figure, run);
    if (missing == 0) continue;
    Lack& lack = lacks[engine_of(run.stage.resolved) == EngineKind::lammps];
    lack.checkpoints += missing;
    lack.runs.insert(run.stage.id.substr(0, 8));
  }
  for (const auto& [of_lammps, lack] : lacks) {
    collected.notes.push_back(fmt::format(
        "never made: {} that the manifest asks for (runs {}); {}",
        counted(lack.checkpoints, "checkpoint"), some_of(lack.runs),
        of_lammps
            ? "these runs are of LAMMPS, which does not repeat bits: `run` and `resume` leave "
              "them out, and the checkpoints cannot be made later"
            : "`shearcell run` with the manifest, or `shearcell resume RUN`, computes them"));
  }
}

/// Whether the experiment asks for a checkpoint of the run that the figure takes, and that is made
/// or can still be made.
bool asks_for_one(const Figure& figure, const FrameRun& run) {
  if (!figure.within || run.stage.kind != name_of(StageKind::shear)) return true;
  double last = last_cycle(figure, run);
  if (run.stage.state == StageState::completed) last = std::min(last, run.stage.cycle);
  return !asked_steps(run.stage, ask_for(figure, run), first_cycle(figure), last).empty();
}

/// Removes the runs without a checkpoint for the figure; notes those and the unfinished ones.
void leave_out_not_begun(const Store& store, const Figure& figure, CollectedRuns& collected) {
  std::set<std::string> not_begun, never, going_on;
  for (const FrameRun& run : collected.runs) {
    const bool failed = run.stage.state == StageState::failed || waits_for_failed(store, run.stage);
    const std::string name =
        fmt::format("{} seed {}{}", run.name, run.place.seed, failed ? " (failed)" : "");
    if (run.checkpoints.empty()) {
      (asks_for_one(figure, run) ? not_begun : never).insert(name);
    } else if (run.stage.state != StageState::completed &&
               run.checkpoints.back().cycle < last_cycle(figure, run)) {
      going_on.insert(name);
    }
    if (!failed && not_begun.contains(name) + going_on.contains(name) > 0) {
      collected.pending.push_back(run);
    }
  }
  std::erase_if(collected.runs, [](const FrameRun& run) { return run.checkpoints.empty(); });
  for (const auto* names : {&not_begun, &never}) {
    if (names->empty()) continue;
    const auto [first, last] = figure.within.value_or(whole_run);
    const std::string which = !figure.within  ? ""
                              : first == last ? fmt::format(" at cycle {}", first)
                                              : fmt::format(" in cycles {} to {}", first, last);
    collected.notes.push_back(fmt::format("left out: {} without a checkpoint{}{}: {}",
                                          counted(names->size(), "run"), which,
                                          names == &never ? "" : " yet", some_of(*names)));
  }
  if (!going_on.empty()) {
    collected.notes.push_back(
        fmt::format("not finished, and taken as if ended where they are: {}: {}",
                    counted(going_on.size(), "run"), some_of(going_on)));
  }
}

/// The stage that settled the packing from which the stage descends, or the file that all packings
/// of its seeds are made of; "" if there is none.
std::string packing_of(const Store& store, const Stage& stage) {
  std::string packing = stage.parent;
  std::set<std::string> seen;  // a forged record may name itself
  while (!packing.empty() && seen.insert(packing).second) {
    const Stage before = store.stage(packing);
    const nlohmann::json file = member_of(member_of(before.resolved, "start"), "file");
    if (file.is_string()) return file.get<std::string>();
    if (before.parent.empty()) break;
    packing = before.parent;
  }
  return packing;
}

std::string unknown_name(const char* what, const std::string& name,
                         const std::vector<std::string_view>& known) {
  return fmt::format("there is no {} {}; {}", what, name, did_you_mean(name, known));
}

/// Sets FrameRun::core_time_s. Notes if the runs were computed by different processors.
void add_core_times(const Store& store, CollectedRuns& collected) {
  std::set<std::string> processors;
  for (FrameRun& run : collected.runs) {
    ComputingTime time = computing_time(store, run.stage.id, run.end);
    run.core_time_s = time.core_seconds;
    processors.merge(time.processors);
  }
  if (processors.size() < 2) return;
  collected.notes.push_back(
      fmt::format("core times are of different processors: {}", some_of(processors)));
}

/// Sets Run::name and Run::named of the runs of this experiment.
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

/// Sets Frame::seeds, Frame::looks, and in Frame::pending the planned runs that are not declared.
void add_planned(const Manifest& manifest, CollectedRuns& collected) {
  for (const Scale& scale : scales_of(manifest)) {
    if (scale.name != collected.scale || variant_count(scale.sweep) > ManifestLimits::runs)
      continue;
    const std::vector<std::uint64_t>& seeds = scale.seeds.values;
    for (const std::uint64_t seed : seeds) {
      if (std::ranges::count(collected.seeds, seed) == 0) collected.seeds.push_back(seed);
    }
    collected.looks = scale.looks;
    const std::vector<Variant> variants = variants_of(scale);
    const std::vector<FrameRun> runs = planned_runs(manifest, scale, variants);
    for (std::size_t k = 0; k < variants.size(); ++k) {
      for (const std::uint64_t seed :
           std::span(seeds).first(std::min<std::size_t>(variants[k].seeds, seeds.size()))) {
        const bool declared = std::ranges::any_of(collected.runs, [&](const FrameRun& run) {
          return run.place.seed == seed && run.place.experiment == manifest.experiment &&
                 run.place.swept == variants[k].swept;
        });
        if (declared) continue;
        collected.pending.push_back(runs[k]);
        collected.pending.back().place.seed = seed;
      }
    }
  }
}

/// Makes the experiment a swept value of the run.
void add_experiment(FrameRun& run) {
  const std::string& experiment = run.place.experiment;
  run.place.swept["experiment"] = experiment;
  run.place.variant = fmt::format("experiment={}{}{}", experiment,
                                  run.place.variant.empty() ? "" : ",", run.place.variant);
  run.name = fmt::format("{}{}{}", experiment, run.name.empty() ? "" : ": ", run.name);
}

/// Makes one list of the runs of several experiments: a stage that two of them share is a run of
/// the first. Notes experiments without runs.
void join(const std::vector<std::string>& experiments, CollectedRuns& collected) {
  std::set<std::string> known;
  std::vector<FrameRun> joined;
  for (const std::string& experiment : experiments) {
    bool any = false;
    for (FrameRun& run : collected.runs) {
      if (run.place.experiment != experiment) continue;
      any = true;
      if (!known.insert(run.stage.id).second) continue;
      add_experiment(run);
      joined.push_back(std::move(run));
    }
    if (!any) collected.notes.push_back("left out: experiment without runs: " + experiment);
  }
  collected.runs = std::move(joined);
  std::ranges::for_each(collected.pending, add_experiment);
}

/// The selected runs of any version of the manifest, at least one. Throws NotFound.
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
    throw NotFound(
        fmt::format("no run selected belongs to figure {}; `status` lists the runs of the store, "
                    "`run` adds those of a manifest",
                    wanted.path()));
  }
  return found;
}

/// The scale of the last run that a newest manifest declared; else that of the last run.
std::string last_scale(const std::vector<Run>& runs,
                       const std::vector<RegisteredManifest>& manifests) {
  const auto is_newest = [&](const Run& run) {
    return std::ranges::find(manifests, run.place.manifest, &RegisteredManifest::sha256) !=
           manifests.end();
  };
  const auto last = std::ranges::find_if(runs.rbegin(), runs.rend(), is_newest);
  return (last == runs.rend() ? runs.back() : *last).place.scale;
}

/// Sets WantedFigure::also.
void share_needs(std::vector<WantedFigure>& figures) {
  std::map<std::string, std::set<std::string>> needs;  // of each experiment
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

}  // namespace

FrameRun figure_run(Run run) {
  FrameRun made{std::move(run)};
  made.parameters = effective_parameters(made.stage.resolved);
  made.parameters.emplace("pressure_at", name_of(PressureAt::top));  // where that key has no effect
  return made;
}

void leave_out_unmeasured(FrameRun& run) {
  std::erase_if(run.checkpoints, [](const CheckpointMeasures& one) {
    return std::ranges::count(one.lacking, "scalars") > 0;
  });
  run.end = std::min(run.end, run.stage.cycle);
}

void measure_runs(const Store& store, std::vector<FrameRun>& runs,
                  std::span<const std::string> providers, const MeasureOptions& options,
                  MeasureOutcome& outcome,
                  const std::function<bool(const FrameRun&, std::size_t)>& wanted) {
  std::vector<ToMeasure> chosen;
  for (FrameRun& run : runs) {
    for (std::size_t k = 0; k < run.checkpoints.size(); ++k) {
      if (wanted && !wanted(run, k)) continue;
      chosen.push_back({&run.checkpoints[k], run.ask.checkpoint_every});
    }
  }
  if (!chosen.empty()) outcome += measure_checkpoints(store, chosen, providers, options);
}

std::string WantedFigure::path() const {
  return experiment.empty() ? figure.name : experiment + "/" + figure.name;
}

WantedFigures wanted_figures(const Store& store, const std::vector<std::string>& names,
                             const std::vector<std::string>& experiments) {
  std::vector<RegisteredManifest> manifests = newest_manifests(store);
  std::vector<std::string_view> registered;
  for (const RegisteredManifest& manifest : manifests) registered.emplace_back(manifest.experiment);
  for (const std::string& experiment : experiments) {
    if (std::ranges::count(registered, experiment) == 0) {
      throw NotFound(unknown_name("experiment", experiment, registered));
    }
  }
  const auto among = [](const std::vector<std::string>& some, const std::string& name) {
    return some.empty() || std::ranges::count(some, name) > 0;
  };
  std::erase_if(manifests, [&](const auto& m) { return !among(experiments, m.experiment); });
  const auto asked = [&](const std::string& name) { return among(names, name); };
  const bool named = !experiments.empty() && !names.empty();
  const std::vector<std::string> registered_names(registered.begin(), registered.end());
  WantedFigures wanted;
  std::vector<std::string_view> supplement;
  for (const Figure& figure : all_figures()) supplement.emplace_back(figure.name);
  std::set<std::string> known(supplement.begin(), supplement.end()), reported;
  for (const RegisteredManifest& manifest : manifests) {
    std::vector<Figure> stated = stated_figures(recorded_manifest(manifest.text));
    for (const Figure& figure : all_figures()) {
      const bool lists = std::ranges::count(manifest.figures, figure.name) > 0;
      const bool across = figure.form == FigureForm::table || !figure.of.empty();
      if (across || !asked(figure.name) || !(named || lists)) continue;
      if (find_named(std::span<const Figure>(stated), figure.name) != nullptr) continue;
      wanted.figures.push_back({figure, manifest.experiment});
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
  // Without names, table1 is drawn only if a manifest lists figures of the supplement.
  const bool lists_any = std::ranges::any_of(
      manifests, [](const RegisteredManifest& manifest) { return !manifest.figures.empty(); });
  for (const Figure& figure : all_figures()) {
    if (manifests.empty() || !asked(figure.name)) continue;
    const auto registers = [&](const std::string& of) { return among(registered_names, of); };
    // A comparison of several experiments is drawn if the store has two of them.
    const bool wanted_without_name = figure.of.empty()
                                         ? figure.form == FigureForm::table && lists_any
                                         : std::ranges::count_if(figure.of, registers) > 1;
    if (figure.form != FigureForm::table && figure.of.empty()) continue;
    if (names.empty() && !wanted_without_name) continue;
    if (experiments.empty() || named) wanted.figures.push_back({figure, ""});
  }
  for (const std::string& name : names) {
    if (!known.contains(name))
      throw NotFound(unknown_name("figure", name, {known.begin(), known.end()}));
  }
  share_needs(wanted.figures);
  return wanted;
}

CollectedRuns collect_runs(const Store& store, const WantedFigure& wanted,
                           const RunSelection& selection, const MeasureOptions& measuring) {
  const std::vector<RegisteredManifest> manifests = newest_manifests(store);
  CollectedRuns collected;
  std::vector<Run> selected = runs_of(store, wanted, selection);
  collected.scale = last_scale(selected, manifests);
  std::set<std::string> at_scale, elsewhere;  // experiments
  std::erase_if(selected, [&](const Run& s) {
    const bool is_at_scale = s.place.scale == collected.scale;
    (is_at_scale ? at_scale : elsewhere).insert(s.place.experiment);
    return !is_at_scale;
  });
  std::erase_if(elsewhere, [&](const std::string& name) { return at_scale.contains(name); });
  if (!elsewhere.empty()) {
    collected.notes.push_back(fmt::format("left out: experiments without a run at scale {}: {}",
                                          scale_name(collected.scale), some_of(elsewhere)));
  }
  NewestRuns newest = newest_runs(std::move(selected));
  if (newest.runs.empty()) {
    throw NotFound(fmt::format(
        "the runs selected for figure {} are of an older version of the manifest; run the version "
        "that states them, which computes nothing new",
        wanted.path()));
  }
  std::ranges::move(newest.notes, std::back_inserter(collected.notes));
  std::map<std::string, std::string> packings;  // by the stage before
  for (Run& run : newest.runs) {
    FrameRun& one = collected.runs.emplace_back(figure_run(std::move(run)));
    const auto [packing, fresh] = packings.try_emplace(one.stage.parent);
    if (fresh) packing->second = packing_of(store, one.stage);
    one.packing = packing->second;
  }
  const bool measured = wanted.figure.form != FigureForm::table;
  if (measured) {
    std::set<std::string> experiments;
    for (const FrameRun& run : collected.runs) experiments.insert(run.place.experiment);
    const bool all_seeds = selection.seeds.empty() && selection.variants.empty();
    for (const RegisteredManifest& manifest : manifests) {
      if (!experiments.contains(manifest.experiment)) continue;
      const Manifest stated = recorded_manifest(manifest.text);
      name_variants(stated.labels, manifest.experiment, collected);
      if (all_seeds) add_planned(stated, collected);
    }
    if (!wanted.figure.of.empty()) join(wanted.figure.of, collected);
    for (const FrameRun& run : collected.runs) collected.variants.push_back(run.place.swept);
    std::erase_if(collected.runs, [&](const FrameRun& run) {
      return wanted.figure.uses && !wanted.figure.uses(run);
    });
  } else {
    std::set<std::pair<std::string, std::string>> known;
    std::erase_if(collected.runs, [&](const FrameRun& run) {
      return !known.emplace(run.place.experiment, run.stage.id).second;
    });
  }
  for (FrameRun& run : collected.runs) {
    run.end = measured ? end_for(store, run.stage, run.ask, measuring)
                       : static_cast<double>(run.ask.target_cycles);
    add_checkpoints(store, wanted.figure, run);
  }
  if (measured) {
    leave_out_not_begun(store, wanted.figure, collected);
    if (std::ranges::count(wanted.figure.needs, "cost") > 0) add_core_times(store, collected);
    note_never_made(wanted.figure, collected);
  }
  for (const FrameRun& run : collected.runs) {
    const nlohmann::json& resolved = run.stage.resolved;
    if (resolved.is_object() &&
        resolved.value("parameters", nlohmann::json::object()).is_object()) {
      continue;
    }
    throw StoreDamaged(fmt::format(
        "the record of run {:.8} has no parameters; `shearcell verify` reports all damage",
        run.stage.id));
  }
  return collected;
}

}  // namespace shearcell
