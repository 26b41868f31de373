// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/select_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {
namespace {

/// One filter, and what it has seen: all values, and those of the wanted that were found.
struct Filter {
  const char* what;
  std::vector<std::string> wanted;
  bool (*fits)(const std::string& wanted, const std::string& value);
  std::set<std::string> values = {};
  std::set<std::string> found = {};

  bool passes(const std::string& value) {
    values.insert(value);
    bool passes = wanted.empty();
    for (const std::string& one : wanted) {
      if (!fits(one, value)) continue;
      found.insert(one);
      passes = true;
    }
    return passes;
  }

  void require_found() const {
    for (const std::string& one : wanted) {
      if (found.contains(one)) continue;
      const std::vector<std::string_view> known(values.begin(), values.end());
      const std::string nearest = suggest_name(one, known).name;
      throw NotFound(fmt::format("no run of the store has {} {}; {}", what, one,
                                 nearest.empty() ? fmt::format("it has {}", fmt::join(known, "; "))
                                                 : "did you mean " + nearest + "?"));
    }
  }
};

}  // namespace

Membership first_membership(const RunRecord& run) {
  return run.memberships.empty() ? Membership{} : run.memberships.front();
}

std::vector<SelectedRun> select_runs(const Store& store, const RunSelection& selection) {
  const auto same = [](const std::string& a, const std::string& b) { return a == b; };
  Filter experiment{"experiment", selection.experiments, same};
  Filter scale{"scale", selection.scales, same};
  Filter variant{"variant", selection.variants, has_values};
  std::vector<std::string> seeds;
  for (const std::uint64_t seed : selection.seeds) seeds.push_back(std::to_string(seed));
  Filter seed{"seed", seeds, same};
  std::vector<SelectedRun> selected;
  for (const RunRecord& run : store.runs()) {
    std::vector<Membership> memberships = run.memberships;
    if (memberships.empty()) memberships.emplace_back();
    for (const Membership& m : memberships) {
      // Not by &&: each has to see every value.
      bool passes = experiment.passes(m.experiment);
      passes &= scale.passes(m.scale);
      passes &= variant.passes(m.variant);
      passes &= seed.passes(std::to_string(m.seed));
      passes &=
          selection.states.empty() || std::ranges::count(selection.states, name_of(run.state)) > 0;
      if (passes) selected.push_back({run, m});
    }
  }
  for (const Filter* filter : {&experiment, &scale, &variant, &seed}) filter->require_found();
  return selected;
}

}  // namespace shearcell
