// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/select_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "experiments/manifest/filter.hpp"
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

/// When each version of a manifest was registered last, by its SHA-256: larger is newer.
using Versions = std::map<std::string, std::size_t>;

Versions versions_of(const Store& store) {
  Versions versions;
  std::size_t registered = 0;
  for (const RegisteredManifest& manifest : registered_manifests(store)) {
    versions[manifest.sha256] = ++registered;
  }
  return versions;
}

/// The same of all versions of a manifest.
auto place(const Membership& m) {
  return std::tie(m.experiment, m.scale, m.variant, m.seed);
}

/// Of a run that an edited manifest declared again, the newest place alone.
std::vector<Membership> newest_memberships(const RunRecord& run, Versions& versions) {
  std::vector<Membership> newest;
  for (const Membership& m : run.memberships) {
    const auto same = std::ranges::find(newest, place(m), place);
    if (same == newest.end()) {
      newest.push_back(m);
    } else if (versions[m.manifest] >= versions[same->manifest]) {
      *same = m;
    }
  }
  if (newest.empty()) newest.emplace_back();
  return newest;
}

/// Newest versions first, then by experiment, scale, variant and seed, so that the order does not
/// depend on the store's history.
bool in_order(const SelectedRun& a, const SelectedRun& b) {
  if (a.of_newest_version != b.of_newest_version) return a.of_newest_version;
  const auto key = [](const Membership& m) {
    return std::tie(m.experiment, m.scale, m.swept, m.seed);
  };
  return key(a.membership) < key(b.membership);
}

using ExperimentScale = std::pair<std::string, std::string>;
ExperimentScale experiment_scale(const Membership& m) {
  return {m.experiment, m.scale};
}

/// Says where an edited manifest asks for fewer cycles than an older version made.
void note_shortened(const std::vector<SelectedRun>& runs, std::vector<std::string>& notes) {
  struct Shortened {
    std::size_t runs = 0;
    double had = 0;
  };
  std::map<ExperimentScale, Shortened> shortened;
  for (const auto& [run, m, newest] : runs) {
    const bool asked_for_more =
        std::ranges::any_of(run.memberships, [&m = m](const Membership& older) {
          return place(older) == place(m) && older.target_cycles > m.target_cycles;
        });
    if (!asked_for_more || run.cycle <= static_cast<double>(m.target_cycles)) continue;
    Shortened& found = shortened[experiment_scale(m)];
    ++found.runs;
    found.had = std::max(found.had, run.cycle);
  }
  for (const auto& [where, found] : shortened) {
    notes.push_back(fmt::format(
        "experiment {}: {} shown shorter than stored (up to cycle {}), because the newest version "
        "of its manifest asks for fewer cycles; raise its `cycles` to show more",
        where.first, found.runs == 1 ? "1 run is" : fmt::format("{} runs are", found.runs),
        found.had));
  }
}

}  // namespace

Membership first_membership(const RunRecord& run) {
  return run.memberships.empty() ? Membership{} : run.memberships.front();
}

std::vector<SelectedRun> select_runs(const Store& store, const RunSelection& selection) {
  Filter experiment(selection.experiments), scale(selection.scales);
  Filter seed(texts_of(selection.seeds));
  Filter variant(selection.variants, has_values, keys_of);
  std::vector<SelectedRun> selected;
  Versions versions = versions_of(store);
  std::map<ExperimentScale, std::size_t> newest;  // version that has runs, selected or not
  for (const RunRecord& run : store.runs()) {
    const bool packing = run.kind == name_of(Stage::prepare);
    if (packing && !selection.packings) continue;
    for (const Membership& m : newest_memberships(run, versions)) {
      std::size_t& known = newest[experiment_scale(m)];
      if (!packing) known = std::max(known, versions[m.manifest]);
      // Not by &&: each has to see every value.
      bool passes = experiment.passes(m.experiment);
      passes &= scale.passes(scale_name(m.scale));
      passes &= variant.passes(m.variant);
      passes &= seed.passes(std::to_string(m.seed));
      passes &=
          selection.states.empty() || std::ranges::count(selection.states, name_of(run.state)) > 0;
      if (passes) selected.push_back({run, m});
    }
  }
  require_found("experiment", experiment);
  require_found("scale", scale);
  require_found("variant", variant);
  require_found("seed", seed);
  for (SelectedRun& run : selected) {
    const Membership& m = run.membership;
    run.of_newest_version = versions[m.manifest] == newest[experiment_scale(m)];
  }
  return selected;
}

NewestRuns newest_runs(std::vector<SelectedRun> selected, bool all_versions) {
  std::erase_if(selected,
                [](const SelectedRun& s) { return s.run.kind == name_of(Stage::prepare); });
  std::stable_partition(selected.begin(), selected.end(),
                        [](const SelectedRun& s) { return s.of_newest_version; });
  NewestRuns chosen;
  struct Taken {
    std::string manifest;
    std::set<nlohmann::json> variants;
  };
  std::map<std::pair<ExperimentScale, std::string>, Taken> taken;  // by the run's id
  using Seed = std::tuple<ExperimentScale, std::string, std::string, std::uint64_t>;
  std::map<Seed, std::size_t> places;                        // by manifest, variant and seed
  std::map<ExperimentScale, std::vector<std::string>> left;  // variants
  for (SelectedRun& run : selected) {
    const Membership& m = run.membership;
    if (!run.of_newest_version && !all_versions) {
      left[experiment_scale(m)].push_back(m.variant);
      continue;
    }
    // A run that is several variants of one manifest is listed for each of them.
    Taken& of_run =
        taken.try_emplace({experiment_scale(m), run.run.id}, Taken{m.manifest, {}}).first->second;
    if (of_run.manifest != m.manifest || !of_run.variants.insert(m.swept).second) continue;
    const auto [place, first] = places.try_emplace(
        {experiment_scale(m), m.manifest, m.variant, m.seed}, chosen.runs.size());
    if (first) {
      chosen.runs.push_back(std::move(run));
      continue;
    }
    // The same manifest meant another run to another version of the program.
    SelectedRun& known = chosen.runs[place->second];
    chosen.notes.push_back(fmt::format(
        "experiment {}: run {:.8} ({}, seed {}) is left out: the manifest was later declared with "
        "run {:.8} in its place",
        m.experiment, known.run.id, m.variant, m.seed, run.run.id));
    known = std::move(run);
  }
  std::ranges::stable_sort(chosen.runs, in_order);
  note_shortened(chosen.runs, chosen.notes);
  for (const auto& [where, variants] : left) {
    chosen.notes.push_back(fmt::format(
        "experiment {}: left out: {} of another version of its manifest: {}; --all-versions adds "
        "them",
        where.first, counted(variants.size(), "run"),
        some_of(std::set<std::string>(variants.begin(), variants.end()))));
  }
  return chosen;
}

}  // namespace shearcell
