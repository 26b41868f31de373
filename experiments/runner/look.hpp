// SPDX-License-Identifier: GPL-3.0-or-later
// outlook() of the stages of a store or a plan.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/manifest/expand.hpp"
#include "experiments/runner/measure.hpp"
#include "experiments/runner/outlook.hpp"
#include "provenance/limits.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// For all recorded asks. Nothing is measured: only recorded ends by `until` are known. If an ask
/// cannot be read, Outlook::unreadable says why.
Outlook look_at(const Store& store, const Stage& stage);

/// A stage of a plan, with what the store has recorded of it.
struct PlannedStage {
  const PlannedRun* run = nullptr;  ///< the first that has it
  Stage stage = {};
  std::vector<Ask> asks = {};  ///< those of the store and of the plan
  std::vector<SeenCheckpoint> checkpoints = {};
  Outlook look = {};
};

/// The stages of the plan's runs, each once, parents first. `store` may be null. Throws as
/// outlook().
std::vector<PlannedStage> look_at(const Plan& plan, const Store* store);

/// outlook() for these asks, with the measures that decide where `until` ends the stage: they are
/// read from the cache, or computed and cached, as long as there is an undecided checkpoint.
/// `checkpoints` keeps them. Throws FilePruned or StoreDamaged, with the remedy, where a checkpoint
/// cannot be read that may end the stage.
Outlook decide(const Store& store, const Stage& stage, std::span<const Ask> asks,
               std::vector<SeenCheckpoint>& checkpoints, const MeasureOptions& options);

/// All checkpoints of the stage but the rejected ones, without measures.
std::vector<SeenCheckpoint> seen_checkpoints(const Store& store, const std::string& stage);

/// The last cycle of the stage that counts for one of its asks, whatever other experiments asked
/// for: Outlook::end. Throws as decide().
double end_for(const Store& store, const Stage& stage, const Ask& ask,
               const MeasureOptions& options);

/// The checkpoints of cycles `first` to `last` that one of `asks` wants, including pruned ones: on
/// its cadence, at its phases and at its last cycle. Of another kind of stage than a shear, and
/// without asks, all at whole cycles. Checkpoints that interruptions and other experiments left are
/// not included, so that figures and tables do not depend on them.
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const Stage& stage,
                                              std::span<const Ask> asks, double first = 0,
                                              double last = StoreLimits::cycles);

/// The checkpoints of one ask, up to end_for().
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const Stage& stage,
                                              const Ask& ask, const MeasureOptions& options);

/// Outlook::ended as recorded, of a stage that is completed before its last cycle; else null. With
/// "cycles_asked" where the stage ended later, at the length that another experiment asked for.
nlohmann::json end_of(const Stage& stage);

/// "crystalline_percent >= 10 at cycle 25 and 15 more cycles"; "" for null.
std::string describe_end(const nlohmann::json& ended);

/// Mean cycle at which this `until` ended stages; nothing if it ended none.
std::optional<double> expected_end(std::span<const Stage> stages, const nlohmann::json& until);

}  // namespace shearcell
