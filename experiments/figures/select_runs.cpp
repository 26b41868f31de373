// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/select_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

#include "experiments/manifest/filter.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"

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
  Filter variant(selection.variants, has_values);
  std::vector<SelectedRun> selected;
  for (const RunRecord& run : store.runs()) {
    for (const Membership& m : newest_memberships(run)) {
      // Not by &&: each has to see every value.
      bool passes = experiment.passes(m.experiment);
      passes &= scale.passes(m.scale.empty() ? "base" : m.scale);
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

}  // namespace shearcell
