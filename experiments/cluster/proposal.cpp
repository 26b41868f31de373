// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/proposal.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace shearcell {
namespace {

constexpr std::size_t kMostCpus = 16;

std::vector<RunRecord> runs_of(const Store* store) {
  return store == nullptr ? std::vector<RunRecord>{} : store->runs();
}

/// Particle-steps left of a stage; nothing when it is done.
std::optional<double> left_of(const PlannedRun& run, const StageSpec& stage,
                              const std::map<std::string, RunRecord>& known, const Store* store) {
  const auto found = known.find(stage.key);
  const RunRecord* record = found == known.end() ? nullptr : &found->second;
  const auto cycle = cycle_to_continue(run, stage, record, store);
  if (!cycle) return std::nullopt;
  return stage_cost(run, stage, *cycle).particle_steps;
}

}  // namespace

std::vector<Bundle> work_left(const std::vector<Plan>& plans, const Store* store) {
  std::map<std::string, RunRecord> known;
  for (RunRecord& run : runs_of(store)) known.emplace(run.id, run);
  std::vector<Bundle> bundles;
  std::map<std::string, std::size_t> places;  // of each packing in bundles
  for (const PlannedRun& run : joined(plans).runs) {
    const auto left = left_of(run, run.last, known, store);
    if (!left) continue;
    const auto [place, fresh] = places.try_emplace(run.prepare.key, bundles.size());
    if (fresh) {
      bundles.push_back({run.prepare.key, {}, left_of(run, run.prepare, known, store).value_or(0)});
    }
    bundles[place->second].runs.push_back(run.last.key);
    bundles[place->second].particle_steps += *left;
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
  std::uint64_t grains = 0;
  for (const Plan& plan : plans) {
    for (const PlannedRun& run : plan.runs) grains = std::max(grains, run.parameters.grains);
  }
  made.rate = Rates(runs_of(store)).of(EngineKind::shearcell, static_cast<double>(grains));
  return made;
}

double seconds_of(const Share& share, const Proposal& proposal) {
  const std::size_t busy = std::min(proposal.job.cpus, share.runs.size() * proposal.job.threads);
  return share.particle_steps /
         (proposal.rate.particle_steps_per_second * static_cast<double>(busy));
}

}  // namespace shearcell
