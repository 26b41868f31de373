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
#include "protocols/cyclic_shear.hpp"
#include "provenance/records.hpp"

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
Outlook outlook(const Stage& stage, std::span<const Ask> asks,
                std::span<const SeenCheckpoint> checkpoints);

/// Whether `until` may end the stage before the number of cycles that is asked for.
bool has_until(const Ask& ask);

/// The motion of the walls in a shear; nothing for another kind of stage, and for a record that
/// this program cannot read (`verify` names it).
std::optional<Drive> shear_drive(const Stage& stage);

/// When the asks want checkpoints of a shear. Throws as outlook().
std::vector<CheckpointCadence> cadences_of(std::span<const Ask> asks, const Drive& drive);

/// Steps of a shear, from cycle `first` to cycle `last`, at which `ask` wants a checkpoint;
/// ascending, at most a million. Empty if there is no shear_drive().
std::vector<std::uint64_t> asked_steps(const Stage& stage, const Ask& ask, double first,
                                       double last);

/// The longest interval [cycles] that gives every ask its checkpoints at whole cycles.
std::uint64_t checkpoint_cadence(std::span<const Ask> asks);

}  // namespace shearcell
