// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/proposal.hpp"

#include <algorithm>
#include <utility>

namespace shearcell {
namespace {

constexpr std::size_t kMostCpus = 16;

}  // namespace

std::set<std::string> busy_runs(const Store& store, const std::vector<OpenSubmission>& open) {
  std::set<std::string> busy;
  for (const OpenSubmission& submission : open) {
    if (submission.queue.empty()) continue;
    for (const auto& task : submission.submission.tasks) busy.insert(task.begin(), task.end());
  }
  for (const Lease& lease : store.leases()) busy.insert(lease.run);
  // Their packings as well, while these are still to be settled.
  const std::vector<RunRecord> runs = store.runs();
  std::set<std::string> parents;
  for (const RunRecord& run : runs) {
    if (busy.contains(run.id)) parents.insert(run.parent);
  }
  for (const RunRecord& run : runs) {
    if (parents.contains(run.id) && run.state != RunState::completed) busy.insert(run.id);
  }
  return busy;
}

Proposal propose(const std::vector<Plan>& plans, const std::vector<RunRecord>& known,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job) {
  Proposal made;
  std::vector<Bundle> bundles = work_left(plans, known);
  std::erase_if(bundles, [&](const Bundle& bundle) {
    const bool taken = busy.contains(bundle.packing) ||
                       std::any_of(bundle.runs.begin(), bundle.runs.end(),
                                   [&busy](const std::string& run) { return busy.contains(run); });
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
  std::size_t grains = 0;
  for (const Plan& plan : plans) {
    for (const PlannedRun& run : plan.runs) grains = std::max(grains, run.grains);
  }
  made.rate = expected_rate(known, EngineKind::shearcell, static_cast<double>(grains));
  return made;
}

double seconds_of(const Share& share, const Proposal& proposal) {
  const std::size_t busy = std::min(proposal.job.cpus, share.runs.size() * proposal.job.threads);
  return share.particle_steps /
         (proposal.rate.particle_steps_per_second * static_cast<double>(busy));
}

}  // namespace shearcell
