// SPDX-License-Identifier: GPL-3.0-or-later
// Computes many stages, several at the same time, each stage after its parent.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "experiments/manifest/expand.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct StageJob {
  std::string id;
  std::string parent;  ///< id of the parent stage, or ""
  std::string name;    ///< display name
};

struct CampaignResult {
  std::size_t completed = 0;  ///< stages that this campaign completed
  std::size_t already = 0;    ///< stages that were done before this campaign
  std::size_t elsewhere = 0;  ///< stages that another process completed during this campaign
  std::size_t failed = 0;     ///< stages stopped by the watchdog, or too large for this machine
  std::size_t interrupted = 0;
  /// Stages that cannot be computed: the parent failed or was interrupted, LAMMPS is missing, the
  /// record cannot be read, or a checkpoint that the stage needs was pruned or never recorded.
  std::size_t blocked = 0;
  std::size_t damaged = 0;        ///< stages with a damaged file in the store
  std::size_t files_deleted = 0;  ///< checkpoint files deleted because of --keep-every
  bool left_failed = false;       ///< failed stages were left out because of --leave-failed
  /// Messages about failed and blocked stages, damaged files, and starting states that this program
  /// cannot recompute bit for bit.
  std::vector<std::string> messages = {};

  bool operator==(const CampaignResult&) const = default;
};

/// Records the manifest and the runs of the plan. Returns the stages of these runs, each stage
/// once, parents first, otherwise in the plan's order.
std::vector<StageJob> declare(Store& store, const Plan& plan);

/// Without `prefixes`: the stages of the store that are not done (Outlook::done), and their
/// parents. Otherwise: the stages whose ids begin with one of the prefixes, and their parents.
/// Throws NotFound if a prefix matches no stage or several stages.
std::vector<StageJob> stages_to_resume(Store& store, const std::vector<std::string>& prefixes);

/// Computes every job that is not done. A failure stops only the stages that depend on the failed
/// stage. Waits for a stage that another process computes. Continues the stage if that process ends
/// before the stage is done, or if the lease of that process expires. Shows progress on standard
/// error unless `quiet`. Calls `when_done` with the id of each stage that the campaign completed.
/// Several threads may call `when_done` at the same time. If it throws, the campaign ends.
CampaignResult run_campaign(Store& store, const std::vector<StageJob>& jobs, std::size_t workers,
                            const Parallel& parallel = {}, bool quiet = false,
                            std::function<void(const std::string& stage)> when_done = {});

}  // namespace shearcell
