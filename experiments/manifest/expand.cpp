// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/expand.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/diagnosis.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "protocols/settle.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

Scale choose_scale(const Manifest& manifest, const std::optional<std::string>& wanted) {
  if (manifest.scales.empty() && wanted.value_or("base") == "base") return manifest.base;
  const std::string name = wanted.value_or("desk");
  if (const Scale* found = find_named(manifest.scales, name)) return *found;
  const std::vector<std::string_view> names = names_of(manifest.scales);
  refuse(manifest.file, {}, "scale", with_nearest("is unknown", name, names), printable(name),
         fmt::format("The manifest has {}; --scale selects one of them.",
                     names.empty() ? "no scales" : fmt::format("{}", fmt::join(names, ", "))));
}

// Checks a value from the command line that replaces a value of the manifest.
void check_option(const Manifest& manifest, const char* key, const nlohmann::json& value,
                  const Field& field) {
  if (const auto wrong = check_value(field, value)) {
    refuse(manifest.file, {}, key, wrong->problem, printable(value_text(value)), wrong->remedy);
  }
}

std::vector<std::uint64_t> choose_seeds(const Manifest& manifest, const Seeds& stated,
                                        const std::optional<std::uint64_t>& wanted) {
  std::vector<std::uint64_t> seeds = stated.values;
  if (!wanted) return seeds;
  check_option(manifest, "seeds", *wanted, {.range = {1, ManifestLimits::runs}, .whole = true});
  if (!stated.counted && *wanted > seeds.size()) {
    refuse(manifest.file, {}, "seeds", "the manifest lists only " + counted(seeds.size(), "seed"),
           std::to_string(*wanted),
           "List more seeds, or write only their number, as in `seeds: 6`.");
  }
  seeds.resize(*wanted);
  if (stated.counted) std::iota(seeds.begin(), seeds.end(), 1);
  return seeds;
}

// Adds the engine as a swept key, so that figures never average runs of two engines.
void set_engine(const Manifest& manifest, const std::string& engine, Scale& scale) {
  check_option(manifest, "engine", engine, *find_field("engine"));
  if (find_axis(scale.sweep, "engine") != nullptr) {
    refuse(manifest.file, {}, "engine", "the manifest already sweeps this key", engine,
           "Leave out `--engine`.");
  }
  if (value_at(scale, "engine") == engine) return;
  std::vector<SweepAxis>& grid = scale.sweep.grid;
  grid.insert(grid.begin(), SweepAxis{"engine", {}, {Setting{engine, {}}}});
}

// `common`: experiment, scale, manifest and checkpoints, which are the same for all runs.
// `recorded`: the run whose state is the initial state of this run, or null. `file`: the initial
// grains, if read from a file.
PlannedRun planned_run(const Membership& common, const Scale& scale, const Variant& variant,
                       std::uint64_t seed, const Stage* recorded,
                       const std::optional<PackingText>& file) {
  PlannedRun run;
  run.place = common.place;
  run.ask = common.ask;
  run.place.variant = variant.name;
  run.place.swept = variant.swept;
  run.place.seed = seed;
  run.parameters = variant.parameters;
  run.ask.target_cycles = target_cycles(run.parameters);
  run.packing = variant.packing;
  if (recorded == nullptr) {
    run.prepare = prepare_stage(run.packing, seed, file ? std::optional(file->file) : std::nullopt);
    // Variants may share a packing. Therefore place.variant of a packing is "packing", not the name
    // of a variant.
    Membership& packing = run.prepare->memberships.emplace_back(common);
    packing.place.variant = "packing";
    packing.place.seed = seed;
    packing.ask.checkpoint_phases.clear();
  }
  run.stage = last_stage(run.parameters, seed, recorded == nullptr ? *run.prepare : *recorded);
  if (run.stage.kind == name_of(StageKind::shear) && scale.until.until) {
    run.ask.until = to_json(*scale.until.until);
  }
  run.stage.memberships = {{run.place, run.ask}};
  return run;
}

// Raises the number of cycles of each variant to the largest number that earlier commands requested
// with this version of the manifest. `place`: manifest, experiment and scale.
void take_declared_lengths(const Place& place, std::span<const Stage> known,
                           std::vector<Variant>& variants) {
  std::map<std::string, std::uint64_t> longest;  // number of cycles by variant
  for (const Stage& stage : known) {
    for (const auto& [other, ask, newest] : stage.memberships) {
      if (other.experiment != place.experiment || other.scale != place.scale) continue;
      if (other.manifest != place.manifest) continue;
      longest[other.variant] = std::max(longest[other.variant], ask.target_cycles);
    }
  }
  for (Variant& variant : variants) {
    variant.parameters.cycles = std::max(variant.parameters.cycles, longest[variant.name]);
  }
}

}  // namespace

std::vector<FrameRun> planned_runs(const Manifest& manifest, const Scale& scale,
                                   std::span<const Variant> variants) {
  const auto names = variant_names(swept_in(variants), manifest.labels);
  Membership common{{.experiment = manifest.experiment, .scale = scale.name}};
  common.ask.checkpoint_every = scale.checkpoints.every_cycles;
  std::vector<FrameRun> runs;
  for (const Variant& variant : variants) {
    const PlannedRun planned = planned_run(common, scale, variant, 1, nullptr, {});
    FrameRun& run = runs.emplace_back(FrameRun{planned});
    run.name = names.at(variant.swept);
    // With `start`, the id of the packing is not known yet. The checks then assume that all
    // variants have the same packing.
    const bool known = !scale.start.is_recorded() && scale.start.file.empty();
    run.packing = known ? planned.prepare->id : "start";
    for (const Field& field : schema()) run.parameters[field.name] = field.get(planned.parameters);
    if (planned.parameters.protocol == ProtocolKind::stiffen) run.ask.checkpoint_every = 1;
  }
  return runs;
}

Plan expand(const Manifest& manifest, const ExpandOptions& options) {
  if (!manifest.of.empty()) {
    return {.manifest = manifest,
            .warnings = warnings_of(manifest),
            .read = fmt::format("{} has no runs of its own. Its figures use the runs of {}.",
                                manifest.experiment, fmt::join(manifest.of, ", "))};
  }
  Scale scale = choose_scale(manifest, options.scale);
  if (options.cycles) {
    check_option(manifest, "cycles", *options.cycles, *find_field("cycles"));
    scale.settings["cycles"] = {*options.cycles, {}};
  }
  std::erase_if(scale.sweep.zip, [&](const SweepAxis& axis) {
    return (axis.key == "cycles" && options.cycles) || (axis.key == "seeds" && options.seeds);
  });
  if (options.engine) set_engine(manifest, *options.engine, scale);
  const std::vector<std::uint64_t> seeds = choose_seeds(manifest, scale.seeds, options.seeds);
  if (variant_count(scale.sweep) > ManifestLimits::runs / seeds.size()) {
    refuse(manifest.file, {}, "seeds",
           fmt::format("the manifest expands to more than {} runs", ManifestLimits::runs), "",
           "Use fewer seeds.");
  }

  std::vector<Variant> variants = variants_of(scale);
  Plan plan{.manifest = manifest, .scale = scale.name};
  if (!scale.start.file.empty()) plan.file = read_packing_file(manifest, scale);
  Membership common{{.experiment = manifest.experiment,
                     .scale = plan.scale,
                     .manifest = sha256_hex(manifest.text)}};
  common.ask.checkpoint_every = scale.checkpoints.every_cycles;
  common.ask.checkpoint_phases = scale.checkpoints.phases;
  std::map<std::string, std::string> variant_of;  // by id of the last stage
  std::set<std::string> fitted;                   // ids of packings that placed() has checked
  Filter wanted(options.variants), seed_filter(options.only_seeds);
  std::vector<std::uint64_t> chosen_seeds = seeds;
  std::erase_if(chosen_seeds,
                [&](std::uint64_t seed) { return !seed_filter.passes(std::to_string(seed)); });
  if (const std::string* missing = seed_filter.unfound()) {
    refuse(manifest.file, {}, "seed", "the manifest does not have this seed", *missing,
           fmt::format("The manifest has {} (--seeds sets the number of seeds).",
                       some_of(seed_filter.seen(), 8)));
  }
  const auto all_names = variant_names(swept_in(variants), manifest.labels);
  std::vector<Variant> chosen;
  for (const Variant& variant : variants) {
    if (!wanted.passes(variant.name, all_names.at(variant.swept))) continue;
    chosen.push_back(variant);
    if (const std::string why = unfit_for_lammps(variant.parameters, scale.checkpoints);
        !why.empty()) {
      refuse(manifest.file, {}, "engine", why, "lammps",
             "Leave out `--engine`, or change the key that LAMMPS does not support.");
    }
    const Stage* recorded = nullptr;
    if (scale.start.is_recorded()) {
      recorded = &recorded_run(manifest, scale, variant, options.known);
    }
    const auto own = std::span(seeds).first(std::min<std::size_t>(variant.seeds, seeds.size()));
    for (const std::uint64_t seed : chosen_seeds) {
      if (std::ranges::count(own, seed) == 0) continue;
      const PlannedRun& run =
          plan.runs.emplace_back(planned_run(common, scale, variant, seed, recorded, plan.file));
      if (plan.file && fitted.insert(run.prepare->id).second) {
        const PlacedGrains grains =
            placed(*plan.file, run.packing, seed);  // throws if the grains do not fit
        plan.read = fmt::format("{}: {}", plan.file->path, grains.read);
        if (!grains.warning.empty()) plan.warnings.push_back(grains.warning);
        const Cell& cell = grains.cell;
        const double height = std::fabs(grains.state.wall_height -
                                        (cell.moving == MovingWall::top ? cell.bottom : cell.top));
        const double time =
            pressing_time(settle_scene(run.packing), height,
                          static_cast<double>(run.packing.grains) / (cell.width * cell.depth));
        if (plan.file->file.settles && time > run.packing.settle_time_limit_s) {
          plan.warnings.push_back(fmt::format(
              "{}: the packing of this file is {:.6g} d high. The moving wall needs about {:.2g} s "
              "to press the grains together, so settling fails at settle_time_limit_s ({:g} s). "
              "Remove the empty space above and below the grains, or raise settle_time_limit_s.",
              plan.file->path, height, time, run.packing.settle_time_limit_s));
        }
      }

      const std::string& same = variant_of.emplace(run.stage.id, run.place.variant).first->second;
      if (same == run.place.variant || seed != chosen_seeds.front()) continue;
      plan.warnings.push_back(fmt::format("{}: variants {} and {} share all runs (computed once)",
                                          manifest.file, same, run.place.variant));
    }
  }
  const std::string* missing = wanted.unfound();
  if (missing != nullptr || plan.runs.empty()) {
    refuse(manifest.file, {}, "variant", "no variant has these values",
           printable(missing != nullptr ? *missing
                                        : fmt::format("{}", fmt::join(options.variants, " and "))),
           fmt::format("The variants are {}.", fmt::join(wanted.seen(), "; ")));
  }
  std::vector<nlohmann::json> swept;
  for (const PlannedRun& run : plan.runs) swept.push_back(run.place.swept);
  const auto names = variant_names(swept, manifest.labels);
  for (PlannedRun& run : plan.runs) run.name = names.at(run.place.swept);
  take_declared_lengths(common.place, options.known, variants);
  std::ranges::move(warnings_of(manifest, scale, variants, chosen, seeds.size()),
                    std::back_inserter(plan.warnings));
  return plan;
}

void add_as_computed(const Plan& plan, std::vector<Stage>& known) {
  std::map<std::string, std::size_t> places;  // indices in `known`, by id
  for (std::size_t k = 0; k < known.size(); ++k) {
    places.emplace(known[k].id, k);
    for (auto& [place, ask, newest] : known[k].memberships) {
      const bool same = place.experiment == plan.manifest.experiment && place.scale == plan.scale;
      newest = newest && !same;
    }
  }
  for (const PlannedRun& run : plan.runs) {
    const auto [place, fresh] = places.try_emplace(run.stage.id, known.size());
    if (fresh) known.push_back(run.stage);
    Stage& stage = known[place->second];
    if (!fresh) stage.memberships.push_back({run.place, run.ask});
    stage.cycle = std::max(stage.cycle, static_cast<double>(run.ask.target_cycles));
  }
}

bool asks_for_lammps(const Plan& plan) {
  return std::ranges::any_of(
      plan.runs, [](const PlannedRun& run) { return run.parameters.engine == EngineKind::lammps; });
}

}  // namespace shearcell
