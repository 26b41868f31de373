// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/expand.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/diagnosis.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

constexpr std::string_view kDefaultScale = "desk";

Scale choose_scale(const Manifest& manifest, const std::optional<std::string>& wanted) {
  if (manifest.scales.empty()) {
    if (!wanted || *wanted == "base") return manifest.base;
    refuse(manifest.file, {}, "scale", "the manifest has no scales", printable(*wanted),
           "Leave it out.");
  }
  const std::string name = wanted.value_or(std::string(kDefaultScale));
  if (const Scale* found = find_named(manifest.scales, name)) return *found;
  const std::vector<std::string_view> names = names_of(manifest.scales);
  const std::string known = fmt::format("It has {}.", fmt::join(names, ", "));
  if (!wanted) {
    refuse(manifest.file, {}, "scale", fmt::format("there is no scale {}, the default", name), "",
           fmt::format("Name one with --scale. {}", known));
  }
  refuse(manifest.file, {}, "scale", with_nearest("is unknown", name, names), printable(name),
         known);
}

// Checks an option that replaces what the manifest states.
void check_option(const Manifest& manifest, const char* key, const nlohmann::json& value,
                  const Field& field) {
  if (const auto wrong = check_value(field, value)) {
    refuse(manifest.file, {}, key, wrong->problem, printable(value_text(value)), wrong->remedy);
  }
}

std::vector<std::uint64_t> choose_seeds(const Manifest& manifest, const Seeds& stated,
                                        const std::optional<std::uint64_t>& wanted) {
  if (!wanted) return stated.values;
  check_option(manifest, "seeds", *wanted, {.range = {1, ManifestLimits::runs}, .whole = true});
  if (stated.counted) {
    std::vector<std::uint64_t> seeds(*wanted);
    std::iota(seeds.begin(), seeds.end(), 1);
    return seeds;
  }
  if (*wanted > stated.values.size()) {
    refuse(manifest.file, {}, "seeds",
           fmt::format("the manifest lists {} seeds only", stated.values.size()),
           std::to_string(*wanted), "List more, or state a count.");
  }
  return {stated.values.begin(), stated.values.begin() + static_cast<std::ptrdiff_t>(*wanted)};
}

// Adds the engine as a swept key, so that figures never average runs of two engines.
void set_engine(const Manifest& manifest, const std::string& engine, Scale& scale) {
  check_option(manifest, "engine", engine, *find_field("engine"));
  if (find_axis(scale.sweep, "engine") != nullptr) {
    refuse(manifest.file, {}, "engine", "the manifest sweeps this key itself", engine,
           "Leave the option out.");
  }
  if (value_at(scale, "engine") == engine) return;
  std::vector<SweepAxis>& grid = scale.sweep.grid;
  grid.insert(grid.begin(), SweepAxis{"engine", {}, {Setting{engine, {}}}});
}

bool has_swept_values(const std::string& variant, const std::string& wanted) {
  return wanted.empty() || Filter(std::vector{wanted}).passes(variant);
}

/// The recorded run whose state the variant begins with.
const Stage& run_to_start_from(const Manifest& manifest, const Scale& scale, const Variant& variant,
                               std::span<const Stage> known) {
  const Start& start = scale.start;
  const std::string at_scale = start.scale.empty() ? scale.name : start.scale;
  std::vector<const Stage*> found;
  for (const Stage& stage : known) {
    if (stage.kind != name_of(StageKind::shear)) continue;
    const auto is_it = [&](const Ask& ask) {
      return ask.newest && ask.experiment == start.experiment &&
             scale_name(ask.scale) == scale_name(at_scale) &&
             ask.seed == variant.parameters.start_seed &&
             has_swept_values(ask.variant, start.variant);
    };
    const bool fits = start.run.empty() ? std::ranges::any_of(stage.asks, is_it)
                                        : stage.id.starts_with(start.run);
    if (fits) found.push_back(&stage);
  }
  const std::string what =
      start.run.empty()
          ? fmt::format("run of {} at scale {} with seed {}{}", start.experiment,
                        scale_name(at_scale), variant.parameters.start_seed,
                        start.variant.empty() ? "" : " and " + printable(start.variant))
          : fmt::format("shear whose id begins with {}", start.run);
  if (found.empty()) {
    refuse(manifest.file, start.at, "start", fmt::format("the store has no {}", what), "",
           "Compute it first, or name the store that has it with --store.");
  }
  if (found.size() > 1) {
    refuse(manifest.file, start.at, "start", fmt::format("the store has more than one {}", what),
           "",
           start.run.empty() ? "Single one out: `variant: \"KEY=VALUE\"`."
                             : "State more digits of the id.");
  }
  const double cycle = static_cast<double>(variant.parameters.start_cycle);
  if (found.front()->cycle < cycle) {
    refuse(manifest.file, start.at, "start",
           fmt::format("run {:.8} has no cycle {} yet", found.front()->id, cycle),
           fmt::format("cycle {}", found.front()->cycle), "Extend it first.");
  }
  return *found.front();
}

/// The parameters of the packing that the cell, its grains and their units depend on are those of
/// the recorded run.
void require_same_cell(const Manifest& manifest, const Scale& scale, const Variant& variant,
                       const Stage& recorded) {
  const Parameters had = read_stage(recorded.resolved).parameters;
  for (const Field& field : schema()) {
    const bool of_packing = field.identity.stage == StageKind::prepare &&
                            field.identity.distinguishes_runs() &&
                            !field.name.starts_with("settle_");
    if (!of_packing || may_differ_in_settling(field.name)) continue;
    const nlohmann::json mine = field.get(variant.parameters), its = field.get(had);
    if (mine == its) continue;
    refuse(manifest.file, scale.start.at, std::string(field.name),
           fmt::format("differs from that of run {:.8}, whose state this one begins with",
                       recorded.id),
           value_text(mine), fmt::format("State {}.", value_text(its)));
  }
}

// `common`: the facts that all runs of the scale share; `recorded`: the run whose state it begins
// with, or null.
PlannedRun planned_run(const Ask& common, const Scale& scale, const Variant& variant,
                       std::uint64_t seed, const Stage* recorded) {
  PlannedRun run;
  run.ask = common;
  run.ask.variant = variant.name();
  run.ask.swept = variant.swept_values();
  run.ask.seed = seed;
  run.parameters = variant.parameters;
  run.ask.target_cycles = target_cycles(run.parameters);
  run.packing = variant.packing;
  if (recorded == nullptr) run.prepare = prepare_stage(run.packing, seed);
  run.stage = last_stage(run.parameters, seed, recorded == nullptr ? *run.prepare : *recorded);
  if (run.stage.kind == name_of(StageKind::shear) && scale.until.until) {
    run.ask.until = to_json(*scale.until.until);
  }
  run.stage.asks = {run.ask};
  return run;
}

// `place`: manifest, experiment and scale.
void take_declared_lengths(const Place& place, std::span<const Stage> known,
                           std::vector<Variant>& variants) {
  std::map<std::string, std::uint64_t> longest;  // by variant
  for (const Stage& run : known) {
    for (const Ask& m : run.asks) {
      if (m.experiment != place.experiment || m.scale != place.scale) continue;
      if (m.manifest != place.manifest) continue;
      longest[m.variant] = std::max(longest[m.variant], m.target_cycles);
    }
  }
  for (Variant& variant : variants) {
    variant.parameters.cycles = std::max(variant.parameters.cycles, longest[variant.name()]);
  }
}

void name_variants(const Manifest& manifest, Plan& plan) {
  std::vector<nlohmann::json> variants;
  for (const PlannedRun& run : plan.runs) variants.push_back(run.ask.swept);
  const auto names = variant_names(variants, manifest.labels);
  for (PlannedRun& run : plan.runs) run.name = names.at(run.ask.swept);
}

}  // namespace

Plan expand(const Manifest& manifest, const ExpandOptions& options) {
  Scale scale = choose_scale(manifest, options.scale);
  if (options.cycles) {
    check_option(manifest, "cycles", *options.cycles, *find_field("cycles"));
    scale.settings["cycles"] = {*options.cycles, {}};
    std::erase_if(scale.sweep.zip, [](const SweepAxis& axis) { return is_length(axis.key); });
  }
  if (options.engine) set_engine(manifest, *options.engine, scale);
  const std::vector<std::uint64_t> seeds = choose_seeds(manifest, scale.seeds, options.seeds);
  if (variant_count(scale.sweep) > ManifestLimits::runs / seeds.size()) {
    refuse(manifest.file, {}, "seeds",
           fmt::format("the manifest expands to more than {} runs", ManifestLimits::runs), "",
           "Use fewer seeds.");
  }

  std::vector<Variant> variants = variants_of(scale);
  Plan plan{manifest.experiment, scale.name, {}, {}};
  Ask common{
      {.experiment = plan.experiment, .scale = plan.scale, .manifest = sha256_hex(manifest.text)}};
  common.checkpoint_every = scale.checkpoints.every_cycles;
  common.checkpoint_phases = scale.checkpoints.phases;
  std::map<std::string, std::string> variant_of;  // by the last stage's key
  Filter wanted(options.variants), seed_filter(options.only_seeds);
  std::vector<std::uint64_t> chosen_seeds;
  std::ranges::copy_if(seeds, std::back_inserter(chosen_seeds), [&](std::uint64_t seed) {
    return seed_filter.passes(std::to_string(seed));
  });
  if (const std::string* missing = seed_filter.unfound()) {
    refuse(manifest.file, {}, "seed", "the manifest has no such seed", *missing,
           fmt::format("It has {} (--seeds states how many).", some_of(seed_filter.seen(), 8)));
  }
  std::vector<Variant> chosen;
  for (const Variant& variant : variants) {
    if (!wanted.passes(variant.name())) continue;
    chosen.push_back(variant);
    if (const std::string why = unfit_for_lammps(variant.parameters, scale.checkpoints);
        !why.empty()) {
      refuse(manifest.file, {}, "engine", why, "lammps",
             "Leave out `--engine`, or what LAMMPS cannot do in this manifest.");
    }
    const Stage* recorded = nullptr;
    if (scale.start.is_stated()) {
      recorded = &run_to_start_from(manifest, scale, variant, options.known);
      require_same_cell(manifest, scale, variant, *recorded);
    }
    for (const std::uint64_t seed : chosen_seeds) {
      const PlannedRun& run =
          plan.runs.emplace_back(planned_run(common, scale, variant, seed, recorded));
      const std::string& same = variant_of.emplace(run.stage.id, run.ask.variant).first->second;
      if (same == run.ask.variant || seed != chosen_seeds.front()) continue;
      plan.warnings.push_back(fmt::format("{}: variants {} and {} are the same runs, computed once",
                                          manifest.file, same, run.ask.variant));
    }
  }
  if (const std::string* missing = wanted.unfound()) {
    refuse(manifest.file, {}, "variant", "no variant has these values", printable(*missing),
           fmt::format("It has {}.", fmt::join(wanted.seen(), "; ")));
  }
  if (plan.runs.empty()) {
    refuse(manifest.file, {}, "variant", "no variant has all of these values",
           printable(fmt::format("{}", fmt::join(options.variants, " and "))),
           fmt::format("It has {}.", fmt::join(wanted.seen(), "; ")));
  }
  name_variants(manifest, plan);
  take_declared_lengths(common, options.known, variants);
  std::ranges::move(warnings_of(manifest, scale, variants, chosen, seeds.size()),
                    std::back_inserter(plan.warnings));
  return plan;
}

Plan joined(std::span<const Plan> plans) {
  std::vector<std::string> experiments, scales;
  Plan all;
  std::map<std::string, std::size_t> places;  // of a run in all.runs, by its id
  for (const Plan& plan : plans) {
    if (std::ranges::count(experiments, plan.experiment) == 0) {
      experiments.push_back(plan.experiment);
    }
    if (std::ranges::count(scales, scale_name(plan.scale)) == 0) {
      scales.push_back(scale_name(plan.scale));
    }
    for (const PlannedRun& run : plan.runs) {
      const auto [place, fresh] = places.try_emplace(run.stage.id, all.runs.size());
      if (fresh) {
        all.runs.push_back(run);
        continue;
      }
      std::vector<Ask>& asks = all.runs[place->second].stage.asks;
      std::ranges::copy(run.stage.asks, std::back_inserter(asks));
    }
  }
  all.experiment = fmt::format("{}", fmt::join(experiments, ", "));
  all.scale = scales.size() == 1 ? plans.front().scale : fmt::format("{}", fmt::join(scales, ", "));
  return all;
}

bool asks_for_lammps(const Plan& plan) {
  return std::ranges::any_of(
      plan.runs, [](const PlannedRun& run) { return run.parameters.engine == EngineKind::lammps; });
}

}  // namespace shearcell
