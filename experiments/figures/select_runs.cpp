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

/// One filter: what is wanted, what the store has, and what of the wanted was found.
class Filter {
 public:
  Filter(const char* what, std::vector<std::string> wanted,
         bool (*fits)(const std::string& wanted, const std::string& value))
      : what_(what), wanted_(std::move(wanted)), fits_(fits) {}

  bool passes(const std::string& value) {
    values_.insert(value);
    bool passes = wanted_.empty();
    for (const std::string& wanted : wanted_) {
      if (!fits_(wanted, value)) continue;
      found_.insert(wanted);
      passes = true;
    }
    return passes;
  }

  void require_found() const {
    for (const std::string& wanted : wanted_) {
      if (found_.contains(wanted)) continue;
      const std::vector<std::string_view> known(values_.begin(), values_.end());
      const std::string nearest = suggest_name(wanted, known).name;
      throw NotFound(fmt::format("no run of the store has {} {}; {}", what_, wanted,
                                 nearest.empty() ? fmt::format("it has {}", fmt::join(known, "; "))
                                                 : "did you mean " + nearest + "?"));
    }
  }

 private:
  const char* what_;
  std::vector<std::string> wanted_;
  bool (*fits_)(const std::string&, const std::string&);
  std::set<std::string> values_;
  std::set<std::string> found_;
};

}  // namespace

Membership first_membership(const RunRecord& run) {
  return run.memberships.empty() ? Membership{} : run.memberships.front();
}

std::vector<SelectedRun> select_runs(const Store& store, const RunSelection& selection) {
  const auto same = [](const std::string& a, const std::string& b) { return a == b; };
  Filter experiment("experiment", selection.experiments, same);
  Filter scale("scale", selection.scales, same);
  Filter variant("variant", selection.variants, has_values);
  std::vector<std::string> seeds;
  for (const std::uint64_t seed : selection.seeds) seeds.push_back(std::to_string(seed));
  Filter seed("seed", seeds, same);
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
