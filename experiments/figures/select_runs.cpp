// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/select_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "experiments/manifest/filter.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"
#include "experiments/runner/registered.hpp"

namespace shearcell {
namespace {

void require_found(const char* what, const Filter& filter) {
  const std::string* missing = filter.unfound();
  if (missing == nullptr) return;
  const std::vector<std::string> seen = filter.seen();
  const std::vector<std::string_view> known(seen.begin(), seen.end());
  const std::string nearest = suggest_name(*missing, known).name;
  throw NotFound(fmt::format("no run of the store has {} {}; {}", what, *missing,
                             nearest.empty() ? fmt::format("it has {}", fmt::join(known, "; "))
                                             : "did you mean " + nearest + "?"));
}

/// Of a run that an edited manifest declared again, the newest place alone.
std::vector<Membership> newest_memberships(const RunRecord& run) {
  const auto place = [](const Membership& m) {
    return std::tie(m.experiment, m.scale, m.variant, m.seed);
  };
  std::vector<Membership> newest;
  for (const Membership& m : run.memberships) {
    const auto same = std::ranges::find(newest, place(m), place);
    if (same == newest.end()) {
      newest.push_back(m);
    } else {
      *same = m;
    }
  }
  if (newest.empty()) newest.emplace_back();
  return newest;
}

}  // namespace

Membership first_membership(const RunRecord& run) {
  return run.memberships.empty() ? Membership{} : run.memberships.front();
}

std::vector<SelectedRun> select_runs(const Store& store, const RunSelection& selection) {
  std::vector<std::string> seeds;
  for (const std::uint64_t seed : selection.seeds) seeds.push_back(std::to_string(seed));
  Filter experiment(selection.experiments), scale(selection.scales), seed(seeds);
  Filter variant(selection.variants, has_values, keys_of);
  std::vector<SelectedRun> selected;
  for (const RunRecord& run : store.runs()) {
    for (const Membership& m : newest_memberships(run)) {
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
  return selected;
}

std::size_t drop_older_versions(const Store& store, std::vector<SelectedRun>& runs) {
  std::map<std::string, std::size_t> version;  // by the manifest's SHA-256
  std::size_t registered = 0;
  for (const RegisteredManifest& manifest : registered_manifests(store)) {
    version[manifest.sha256] = ++registered;
  }
  const auto place = [](const Membership& m) { return std::pair(m.experiment, m.scale); };
  std::map<std::pair<std::string, std::string>, std::size_t> newest;
  for (const auto& [run, m] : runs) {
    newest[place(m)] = std::max(newest[place(m)], version[m.manifest]);
  }
  return std::erase_if(runs, [&](const SelectedRun& selected) {
    const Membership& m = selected.membership;
    return version[m.manifest] < newest[place(m)];
  });
}

}  // namespace shearcell
