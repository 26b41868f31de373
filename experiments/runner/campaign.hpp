// SPDX-License-Identifier: GPL-3.0-or-later
// Runs many stages, as many at once as there are workers, each after its parent.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "experiments/manifest/expand.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// One stage to bring to its target.
struct StageJob {
  std::string id;
  std::string parent;  ///< id, or ""
  std::string name;    ///< for people
};

struct CampaignResult {
  std::size_t completed = 0;  ///< stages computed now
  std::size_t already = 0;    ///< stages that were done before
  std::size_t elsewhere = 0;  ///< stages that another program completed meanwhile
  std::size_t failed = 0;     ///< stopped by the watchdog, or too large for this machine
  std::size_t interrupted = 0;
  /// Not begun: the stage before failed or was interrupted, LAMMPS is missing, the record cannot be
  /// read, or a pruned checkpoint decides where the stage ends.
  std::size_t blocked = 0;
  std::size_t damaged = 0;            ///< met a damaged file of the store
  std::size_t files_deleted = 0;      ///< of checkpoints, by --keep-every
  std::vector<std::string> messages;  ///< one for each failure, damage or change of bits
};

/// Records the manifest and the runs of the plan. Returns their stages, each once, parents
/// first and otherwise in the plan's order.
std::vector<StageJob> declare(Store& store, const Plan& plan);

/// The stages of the store that are not done by their Outlook, with the stages before them; with
/// `prefixes` only stages whose ids begin with one of these. Throws NotFound for a prefix that fits
/// no stage or several.
std::vector<StageJob> stages_to_resume(Store& store, const std::vector<std::string>& prefixes);

/// Computes every job that is not done. A failure stops only the stages that depend on the failed
/// stage. A stage that another program computes is left to that program, and continued here if the
/// program ends or its lease expires before the stage is done. Shows progress on standard error
/// unless `quiet`. `when_done` is called with the id of each stage that this call completed, by
/// several threads at once; what it throws ends the campaign.
CampaignResult run_campaign(Store& store, const std::vector<StageJob>& jobs, std::size_t workers,
                            const Parallel& parallel = {}, bool quiet = false,
                            std::function<void(const std::string& stage)> when_done = {});

}  // namespace shearcell
