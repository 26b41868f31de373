// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/proposal.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "experiments/manifest/identity.hpp"
#include "experiments/runner/cost.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kMostCpus = 16;

}  // namespace

std::vector<Bundle> work_left(const std::vector<Plan>& plans, const Store* store) {
  const auto runs = store == nullptr ? std::vector<RunRecord>{} : store->runs();
  const Rates rates(runs);
  std::map<std::string, const RunRecord*> known;
  for (const RunRecord& run : runs) known.emplace(run.id, &run);
  // Adds what is left of a stage; false when it is done.
  const auto add = [&](const PlannedRun& run, const StageSpec& stage, Bundle& bundle) {
    const auto found = known.find(stage.key);
    const auto cycle =
        cycle_to_continue(run, stage, found == known.end() ? nullptr : found->second, store);
    if (!cycle) return false;
    const double steps = stage_cost(run, stage, *cycle).particle_steps;
    const Rate rate =
        rates.of(engine_of(stage.resolved), static_cast<double>(run.parameters.grains));
    bundle.particle_steps += steps;
    bundle.core_seconds += steps / rate.particle_steps_per_second;
    return true;
  };
  std::vector<Bundle> bundles;
  std::map<std::string, std::size_t> places;  // of each packing in bundles
  for (const PlannedRun& run : joined(plans).runs) {
    Bundle left;
    if (!add(run, run.last, left)) continue;
    const auto [place, fresh] = places.try_emplace(run.prepare.key, bundles.size());
    if (fresh) {
      bundles.push_back({run.prepare.key, {}});
      add(run, run.prepare, bundles.back());
    }
    Bundle& bundle = bundles[place->second];
    bundle.runs.push_back(run.last.key);
    bundle.particle_steps += left.particle_steps;
    bundle.core_seconds += left.core_seconds;
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
    least->particle_steps += bundle.particle_steps;
    least->core_seconds += bundle.core_seconds;
    ++least->packings;
  }
  return shares;
}

Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job) {
  Proposal made;
  std::vector<Bundle> bundles = work_left(plans, store);
  std::erase_if(bundles, [&](const Bundle& bundle) {
    const bool taken = busy.contains(bundle.packing) ||
                       std::ranges::any_of(
                           bundle.runs, [&](const std::string& run) { return busy.contains(run); });
    if (taken) made.left_out += bundle.runs.size();
    return taken;
  });
  made.shares = share_out(std::move(bundles), most_tasks);
  if (job.cpus == 0) {
    std::size_t most = 1;
    for (const Share& share : made.shares) most = std::max(most, share.runs.size());
    job.cpus = std::max(std::min(kMostCpus, most * job.threads), job.threads);
  }
  made.job = std::move(job);
  return made;
}

double seconds_of(const Share& share, const Proposal& proposal) {
  const std::size_t busy = std::min(proposal.job.cpus, share.runs.size() * proposal.job.threads);
  return share.core_seconds / static_cast<double>(busy);
}

}  // namespace shearcell
