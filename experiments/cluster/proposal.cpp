// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/proposal.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "experiments/manifest/identity.hpp"
#include "experiments/runner/cost.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kMostCpus = 16;

}  // namespace

void Share::add(const Share& other) {
  packings.insert(packings.end(), other.packings.begin(), other.packings.end());
  runs.insert(runs.end(), other.runs.begin(), other.runs.end());
  particle_steps += other.particle_steps;
  core_seconds += other.core_seconds;
}

std::vector<Share> work_left(const std::vector<Plan>& plans, const Store* store) {
  const auto runs = store == nullptr ? std::vector<RunRecord>{} : store->runs();
  const Rates rates(runs);
  std::map<std::string, const RunRecord*> known;
  for (const RunRecord& run : runs) known.emplace(run.id, &run);
  // Adds what is left of a stage; false when it is done.
  const auto add = [&](const PlannedRun& run, const StageSpec& stage, Share& share) {
    const auto found = known.find(stage.key);
    const auto cycle =
        cycle_to_continue(run, stage, found == known.end() ? nullptr : found->second, store);
    if (!cycle) return false;
    const double steps = stage_cost(run, stage, *cycle).particle_steps;
    const Rate rate =
        rates.of(engine_of(stage.resolved), static_cast<double>(run.parameters.grains));
    share.particle_steps += steps;
    share.core_seconds += steps / rate.particle_steps_per_second;
    return true;
  };
  std::vector<Share> shares;
  std::map<std::string, std::size_t> places;  // of each packing in shares
  Plan all = joined(plans);
  take_longer_targets(runs, all);
  for (const PlannedRun& run : all.runs) {
    Share left;
    if (!add(run, run.last, left)) continue;
    left.runs = {run.last.key};
    const auto [place, fresh] = places.try_emplace(run.prepare.key, shares.size());
    if (fresh) {
      shares.emplace_back().packings = {run.prepare.key};
      add(run, run.prepare, shares.back());
    }
    shares[place->second].add(left);
  }
  return shares;
}

std::vector<Share> share_out(std::vector<Share> packings, std::size_t tasks) {
  std::ranges::stable_sort(packings, std::greater(), &Share::core_seconds);
  std::vector<Share> shares(std::min(tasks, packings.size()));
  for (const Share& packing : packings) {
    // The number of packings decides between equal costs, so that no share stays empty.
    const auto load = [](const Share& share) {
      return std::pair(share.core_seconds, share.packings.size());
    };
    std::ranges::min_element(shares, std::less(), load)->add(packing);
  }
  return shares;
}

Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job) {
  Proposal made;
  std::vector<Share> packings = work_left(plans, store);
  std::erase_if(packings, [&](const Share& packing) {
    const auto is_busy = [&](const std::string& id) { return busy.contains(id); };
    const bool taken = std::ranges::any_of(packing.packings, is_busy) ||
                       std::ranges::any_of(packing.runs, is_busy);
    if (taken) made.left_out += packing.runs.size();
    return taken;
  });
  made.shares = share_out(std::move(packings), most_tasks);
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
