// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/select_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "experiments/manifest/parameters.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

void require_found(const char* what, const Filter& filter) {
  const std::string* missing = filter.unfound();
  if (missing == nullptr) return;
  const std::vector<std::string> seen = filter.seen();
  const std::vector<std::string_view> known(seen.begin(), seen.end());
  throw NotFound(fmt::format("no run of the store has {} {}; {}", what, *missing,
                             did_you_mean(*missing, known)));
}

/// The values that identify a run in all versions of a manifest.
auto in_any_version(const Place& place) {
  return std::tie(place.experiment, place.scale, place.variant, place.seed);
}

using ExperimentScale = std::pair<std::string, std::string>;
ExperimentScale experiment_scale(const auto& run) {
  return {run.place.experiment, run.place.scale};
}

/// Returns the places (variant and seed) of the stage in the newest manifest version of each
/// experiment and scale. For an experiment and scale whose newest version lacks the stage, returns
/// the place declared last.
std::vector<Membership> places_of(const Stage& stage) {
  std::vector<Membership> places;
  for (const Membership& m : stage.memberships) {
    const auto known = std::ranges::find(places, experiment_scale(m), experiment_scale<Membership>);
    if (known == places.end() || (known->newest && m.newest)) {
      places.push_back(m);
    } else if (m.newest || !known->newest) {
      *known = m;
    }
  }
  if (places.empty()) places.emplace_back();
  return places;
}

/// Orders runs by experiment, scale, swept values and seed. This order does not depend on the
/// history of the store.
bool in_order(const Run& a, const Run& b) {
  const auto key = [](const Place& place) {
    return std::tie(place.experiment, place.scale, place.swept, place.seed);
  };
  return key(a.place) < key(b.place);
}

/// Adds a note on each experiment whose edited manifest asks for fewer cycles than are stored.
void note_shortened(const std::vector<Run>& runs, std::vector<std::string>& notes) {
  struct Shortened {
    std::size_t runs = 0;
    double had = 0;
  };
  std::map<ExperimentScale, Shortened> shortened;
  for (const Run& run : runs) {
    const bool asked_for_more =
        std::ranges::any_of(run.stage.memberships, [&](const Membership& older) {
          return in_any_version(older.place) == in_any_version(run.place) &&
                 older.ask.target_cycles > run.ask.target_cycles;
        });
    if (!asked_for_more || run.stage.cycle <= static_cast<double>(run.ask.target_cycles)) continue;
    Shortened& found = shortened[experiment_scale(run)];
    ++found.runs;
    found.had = std::max(found.had, run.stage.cycle);
  }
  for (const auto& [where, found] : shortened) {
    notes.push_back(fmt::format(
        "experiment {}: {} not shown to the end (stored up to cycle {}), because the newest "
        "version of its manifest asks for fewer cycles; raise the manifest's `cycles` to show all",
        where.first, found.runs == 1 ? "1 run is" : fmt::format("{} runs are", found.runs),
        found.had));
  }
}

/// If the manifest of an experiment has the key `of`, replaces the experiment by the experiments
/// that `of` lists. Listed experiments without runs of their own are left out.
std::vector<std::string> with_members(const Store& store,
                                      const std::vector<std::string>& experiments) {
  std::vector<std::string> all;
  if (experiments.empty()) return all;
  std::map<std::string, std::vector<std::string>> members;  // experiment -> its manifest's `of`
  for (const RegisteredManifest& one : newest_manifests(store)) {
    members[one.experiment] = one.content.of;
  }
  for (const std::string& experiment : experiments) {
    const auto owns_runs = [&](const std::string& member) {
      const auto found = members.find(member);
      return found != members.end() && found->second.empty();
    };
    const std::size_t before = all.size();
    std::ranges::copy_if(members[experiment], std::back_inserter(all), owns_runs);
    if (all.size() == before) all.push_back(experiment);  // an empty list would select all runs
  }
  return all;
}

}  // namespace

std::vector<Run> select_runs(const Store& store, const RunSelection& selection) {
  Filter experiment(with_members(store, selection.experiments)), scale(selection.scales);
  Filter seed(selection.seeds), variant(selection.variants);
  std::optional<VariantNames> names;
  if (!selection.variants.empty()) names.emplace(store);
  std::vector<Run> selected;
  using Seed = std::tuple<ExperimentScale, std::string, std::uint64_t>;
  std::map<Seed, std::size_t> seeds;  // index in `selected` of the newest run of each seed
  for (const Stage& stage : store.stages()) {
    const bool packing = stage.kind == name_of(StageKind::prepare);
    if (packing && !selection.packings) continue;
    for (const auto& [place, ask, newest] : places_of(stage)) {
      // `&=` evaluates every filter, and each filter must see every value.
      bool passes = experiment.passes(place.experiment);
      passes &= scale.passes(scale_name(place.scale));
      passes &= variant.passes(place.variant, names ? names->of(stage, place) : "");
      passes &= seed.passes(std::to_string(place.seed));
      passes &= selection.states.empty() ||
                std::ranges::count(selection.states, name_of(stage.state)) > 0;
      if (!passes) continue;
      selected.push_back({.place = place, .ask = ask, .stage = stage, .newest = newest});
      if (packing || !newest) continue;
      // If the file of grains or the version of the program changes, a manifest declares a second
      // run for the same seed. Only the run that was declared last counts as newest.
      const Seed same = {experiment_scale(selected.back()), place.variant, place.seed};
      const std::size_t first = seeds.try_emplace(same, selected.size() - 1).first->second;
      if (first == selected.size() - 1) continue;
      Run &one = selected[first], &other = selected.back();
      if (one.ask.ordinal < other.ask.ordinal) seeds[same] = selected.size() - 1;
      (one.ask.ordinal < other.ask.ordinal ? one : other).newest = false;
    }
  }
  require_found("experiment", experiment);
  require_found("scale", scale);
  require_found("variant", variant);
  require_found("seed", seed);
  return selected;
}

Place first_place(const Stage& stage) {
  return stage.memberships.empty() ? Place{} : stage.memberships.front().place;
}

NewestRuns newest_runs(std::vector<Run> selected) {
  std::erase_if(selected, [](const Run& s) { return s.stage.kind == name_of(StageKind::prepare); });
  const auto older = std::stable_partition(selected.begin(), selected.end(),
                                           [](const Run& s) { return s.newest; });
  NewestRuns chosen;
  chosen.runs.assign(selected.begin(), older);
  std::ranges::stable_sort(chosen.runs, in_order);
  note_shortened(chosen.runs, chosen.notes);
  // For each experiment, scale and version of the manifest: the variants of left-out runs.
  std::map<std::pair<ExperimentScale, std::string>, std::vector<std::string>> left;
  for (const Run& one : std::ranges::subrange(older, selected.end())) {
    const auto instead = std::ranges::find_if(chosen.runs, [&](const Run& other) {
      return in_any_version(other.place) == in_any_version(one.place) &&
             other.place.manifest == one.place.manifest;
    });
    if (instead == chosen.runs.end()) {
      left[{experiment_scale(one), one.place.manifest}].push_back(
          variant_in_words(one.place.variant));
    } else {
      chosen.notes.push_back(fmt::format(
          "experiment {}: run {:.8} ({}, seed {}) is left out, because the manifest later declared "
          "run {:.8} for this seed",
          one.place.experiment, one.stage.id, variant_in_words(one.place.variant), one.place.seed,
          instead->stage.id));
    }
  }
  for (const auto& [version, variants] : left) {
    const auto& [where, manifest] = version;
    const auto shown = std::ranges::find(chosen.runs, where, experiment_scale<Run>);
    const auto count = std::ranges::count(chosen.runs, where, experiment_scale<Run>);
    chosen.notes.push_back(fmt::format(
        "experiment {}{}: left out: {} of manifest version {:.8} ({}); "
        "shown: {} of the version that was registered last{}",
        where.first, at_scale(where.second), counted(variants.size(), "run"), manifest,
        some_of(std::set<std::string>(variants.begin(), variants.end())),
        counted(static_cast<std::size_t>(count), "run"),
        shown == chosen.runs.end() ? "" : fmt::format(", {:.8}", shown->place.manifest)));
  }
  return chosen;
}

}  // namespace shearcell
