// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of a stage: one function that every command asks.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/measures.hpp"
#include "core/scene.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/runner/measure.hpp"
#include "protocols/cyclic_shear.hpp"
#include "provenance/limits.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// A checkpoint of a stage, recorded or pruned, with its scalar measures if they are known.
struct SeenCheckpoint {
  CheckpointRecord record;
  std::optional<Measures> measures = {};
};

struct Outlook {
  /// The stage is completed for all asks, and no checkpoint is missing.
  bool done = false;
  /// The cycle from which it is computed: that of its last checkpoint, or of the last one before
  /// the first that is missing.
  double from = 0;
  /// Steps before the last checkpoint at which one is asked for and none was ever recorded, as
  /// where a denser cadence was asked for later; ascending. A replay makes them.
  std::vector<std::uint64_t> missing = {};
  /// The same of LAMMPS, which does not repeat bits: nothing makes them.
  std::vector<std::uint64_t> lost = {};
  /// The cycle at which the stage ends: the largest number of cycles that is asked for, less where
  /// `until` is known to end it.
  double end = 0;
  /// Why the stage ends at its last checkpoint by `until`, as RunCompleted records it; else null.
  /// {"by": "until", "measure", "value", "extra_cycles", "reached_at_cycle", "memberships"}.
  nlohmann::json ended = nullptr;
  /// The first checkpoint whose unknown measures may end the stage.
  std::optional<CheckpointRecord> undecided = {};
  // What is left, at most. Of settling it is estimated from what N = 600 to 18200 took.
  double checkpoints = 0;
  double particle_steps = 0;
  double bytes = 0;  ///< of checkpoint files, estimated
  /// Why this program cannot read the stage's parameters; then nothing is known of what is left.
  std::string unreadable = {};
};

/// `stage` with the progress and the asks that the store has recorded, or a new one; `asks`: those
/// that count, which may be more or fewer; `checkpoints`: all of the stage in the order of steps,
/// without rejected ones. A completed stage also meets an ask with the `until` of a recorded one
/// that asks for at least as many cycles. Throws StoreDamaged for an ask that no manifest can
/// state.
Outlook outlook(const RunRecord& stage, std::span<const Membership> asks,
                std::span<const SeenCheckpoint> checkpoints);

/// Whether `until` may end the stage before the number of cycles that is asked for.
bool has_until(const Membership& ask);

/// The motion of the walls in a shear; nothing for another kind of stage, and for a record that
/// this program cannot read (`verify` names it).
std::optional<Drive> shear_drive(const RunRecord& stage);

/// When the asks want checkpoints of a shear. Throws as outlook().
std::vector<CheckpointCadence> cadences_of(std::span<const Membership> asks, const Drive& drive);

/// Steps of a shear, from cycle `first` to cycle `last`, at which `ask` wants a checkpoint;
/// ascending, at most a million. Empty if there is no shear_drive().
std::vector<std::uint64_t> asked_steps(const RunRecord& stage, const Membership& ask, double first,
                                       double last);

/// The longest interval [cycles] that gives every ask its checkpoints at whole cycles.
std::uint64_t checkpoint_cadence(std::span<const Membership> asks);

// --- Of the stages of a store or a plan ---

/// outlook() for all recorded asks. Nothing is measured: only recorded ends by `until` are known.
/// If an ask cannot be read, Outlook::unreadable says why.
Outlook look_at(const Store& store, const RunRecord& stage);

/// A stage of a plan, with what the store has recorded of it.
struct PlannedStage {
  const PlannedRun* run = nullptr;  ///< the first that has it
  RunRecord stage = {};
  std::vector<Membership> asks = {};  ///< those of the store and of the plan
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
Outlook decide(const Store& store, const RunRecord& stage, std::span<const Membership> asks,
               std::vector<SeenCheckpoint>& checkpoints, const MeasureOptions& options);

/// All checkpoints of the stage but the rejected ones, without measures.
std::vector<SeenCheckpoint> seen_checkpoints(const Store& store, const std::string& stage);

/// The last cycle of the stage that counts for one of its asks, whatever other experiments asked
/// for: Outlook::end. Throws as decide().
double end_for(const Store& store, const RunRecord& stage, const Membership& ask,
               const MeasureOptions& options);

/// The checkpoints of cycles `first` to `last` that one of `asks` wants, including pruned ones: on
/// its cadence, at its phases and at its last cycle. Of another kind of stage than a shear, and
/// without asks, all at whole cycles. Checkpoints that interruptions and other experiments left are
/// not included, so that figures and tables do not depend on them.
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const RunRecord& stage,
                                              std::span<const Membership> asks, double first = 0,
                                              double last = StoreLimits::cycles);

/// The checkpoints of one ask, up to end_for().
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const RunRecord& stage,
                                              const Membership& ask, const MeasureOptions& options);

/// Outlook::ended as recorded, of a stage that is completed before its last cycle; else null. With
/// "cycles_asked" where the stage ended later, at the length that another experiment asked for.
nlohmann::json end_of(const RunRecord& stage);

/// "crystalline_percent >= 10 at cycle 25 and 15 more cycles"; "" for null.
std::string describe_end(const nlohmann::json& ended);

/// Mean cycle at which this `until` ended stages; nothing if it ended none.
std::optional<double> expected_end(std::span<const RunRecord> stages, const nlohmann::json& until);

}  // namespace shearcell
