// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/share.hpp"

#include <algorithm>
#include <map>

#include "experiments/runner/cost.hpp"

namespace shearcell {
namespace {

/// Particle-steps left of a stage; nothing when it is done.
std::optional<double> left_of(const PlannedRun& run, const StageSpec& stage,
                              const std::map<std::string, const RunRecord*>& known) {
  const auto found = known.find(stage.key);
  const auto cycle = cycle_to_continue(run, stage, found == known.end() ? nullptr : found->second);
  if (!cycle) return std::nullopt;
  return stage_cost(run, stage, *cycle).particle_steps;
}

}  // namespace

std::vector<Bundle> work_left(const std::vector<Plan>& plans, const std::vector<RunRecord>& known) {
  std::map<std::string, const RunRecord*> by_id;
  for (const RunRecord& run : known) by_id[run.id] = &run;
  // Two manifests may ask for one run; the longer one decides.
  std::map<std::string, const PlannedRun*> longest;
  for (const Plan& plan : plans) {
    for (const PlannedRun& run : plan.runs) {
      const PlannedRun*& kept = longest[run.last.key];
      if (kept == nullptr || run.cycles > kept->cycles) kept = &run;
    }
  }
  std::vector<Bundle> bundles;
  std::map<std::string, std::size_t> places;  // of each packing in bundles
  std::set<std::string> seen;
  for (const Plan& plan : plans) {
    for (const PlannedRun& planned : plan.runs) {
      if (!seen.insert(planned.last.key).second) continue;
      const PlannedRun& run = *longest.at(planned.last.key);
      const auto left = left_of(run, run.last, by_id);
      if (!left) continue;
      const auto [place, fresh] = places.try_emplace(run.prepare.key, bundles.size());
      if (fresh) {
        bundles.push_back({run.prepare.key, {}, left_of(run, run.prepare, by_id).value_or(0)});
      }
      bundles[place->second].runs.push_back(run.last.key);
      bundles[place->second].particle_steps += *left;
    }
  }
  return bundles;
}

std::vector<Share> share_out(std::vector<Bundle> bundles, std::size_t tasks) {
  std::stable_sort(bundles.begin(), bundles.end(), [](const Bundle& a, const Bundle& b) {
    return a.particle_steps > b.particle_steps;
  });
  std::vector<Share> shares(std::min(tasks, bundles.size()));
  for (const Bundle& bundle : bundles) {
    // Costs may be 0, and no share may stay empty.
    const auto least =
        std::min_element(shares.begin(), shares.end(), [](const Share& a, const Share& b) {
          return std::pair(a.particle_steps, a.packings) < std::pair(b.particle_steps, b.packings);
        });
    least->runs.insert(least->runs.end(), bundle.runs.begin(), bundle.runs.end());
    least->stages.insert(bundle.packing);
    least->stages.insert(bundle.runs.begin(), bundle.runs.end());
    least->particle_steps += bundle.particle_steps;
    ++least->packings;
  }
  return shares;
}

}  // namespace shearcell
