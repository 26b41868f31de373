// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of a stage, and what it costs: one function that every command asks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "analysis/measures.hpp"
#include "core/filling.hpp"
#include "core/scene.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/manifest/parameters.hpp"
#include "experiments/runner/measure.hpp"
#include "protocols/cyclic_shear.hpp"
#include "provenance/limits.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Scalar measures of checkpoints, by SHA-256.
using KnownMeasures = std::map<std::string, Measures>;

struct Outlook {
  /// The stage is completed for all asks and no checkpoint is missing.
  bool done = false;
  /// Ascending steps of missing checkpoints: asked for, before the last checkpoint, and never
  /// recorded, for example because a denser cadence was asked for later. A replay makes them. Empty
  /// for LAMMPS, which does not repeat bits, so that no checkpoint can be made later.
  std::vector<std::uint64_t> missing = {};
  /// The cycle at which the stage ends: the largest number of cycles that is asked for, or an
  /// earlier one at which `until` is known to end the stage.
  double end = 0;
  /// An `until` that is not known to be reached may end the stage before `end`.
  bool may_end_early = false;
  /// How `until` ends the stage at its last checkpoint, as RunCompleted records it; null if it does
  /// not. {"by": "until", "measure", "value", "extra_cycles", "reached_at_cycle", "memberships"}.
  nlohmann::json ended = nullptr;
  /// The first checkpoint whose unknown measures may end the stage.
  std::optional<CheckpointRecord> undecided = {};
  // What is left, at most. For settling this is an estimate from packings of 600 to 18200 grains.
  double checkpoints = 0;
  double particle_steps = 0;
  double bytes = 0;  ///< of checkpoint files, estimated
  /// Why this program cannot read the stage's parameters; what is left is then unknown. "" if it
  /// can.
  std::string unreadable = {};
};

/// What is left of a stage for `asks`. `stage`: a recorded stage, or a new one; its recorded asks
/// need not be `asks`. `checkpoints`: all checkpoints of the stage except rejected ones, by step
/// (Listed::and_pruned). A completed stage also meets an ask if a recorded ask has the same
/// `until` and at least as many cycles. Throws StoreDamaged for an ask that no manifest can state.
Outlook outlook(const Stage& stage, std::span<const Ask> asks,
                std::span<const CheckpointRecord> checkpoints, const KnownMeasures& measures = {});

/// The motion of the walls in a shear; nothing for another kind of stage and for an unreadable
/// record, which `verify` names.
std::optional<Drive> shear_drive(const Stage& stage);

/// The cadences of a shear, one for each ask of at least one cycle. Throws as outlook().
std::vector<CheckpointCadence> cadences_of(const Stage& stage, std::span<const Ask> asks,
                                           const Drive& drive);

/// The checkpoints that asks want of a stage: on their cadences, at their phases and at their last
/// cycles. Checkpoints that interruptions and other experiments left are not among them, so that
/// figures and tables do not depend on those.
struct AskedCheckpoints {
  std::vector<CheckpointRecord> made = {};
  /// Ascending steps before the stage's last checkpoint that were never recorded; at most a
  /// million.
  std::vector<std::uint64_t> missing = {};
  double to_come = 0;  ///< number after the stage's last checkpoint; above 10,000 an estimate
};

/// The checkpoints of cycles `first` to `last`; `checkpoints` as in outlook(). If the stage is not
/// a shear, or there are no asks: the checkpoints that were made at whole cycles.
AskedCheckpoints asked_checkpoints(const Stage& stage, std::span<const Ask> asks,
                                   std::span<const CheckpointRecord> checkpoints, double first = 0,
                                   double last = StoreLimits::cycles);

/// The longest interval [cycles] that includes the whole-cycle checkpoints of every ask.
std::uint64_t checkpoint_cadence(std::span<const Ask> asks);

// --- Of the stages of a store or a plan ---

/// Like outlook() for all recorded asks, but measures nothing: that `until` ended a run is known
/// only if the end is recorded. Outlook::unreadable says why an ask cannot be read.
Outlook look_at(const Store& store, const Stage& stage);

/// A stage of plans, with what the store has recorded of it.
struct PlannedStage {
  const PlannedRun* run = nullptr;  ///< the first run with this stage
  Stage stage = {};
  std::vector<Membership> memberships = {};  ///< in the store and in all plans
  std::vector<CheckpointRecord> checkpoints = {};
  Outlook look = {};
};

/// The stages of the plans' runs, each once, parents first. `store` may be null. Throws as
/// outlook().
std::vector<PlannedStage> look_at(std::span<const Plan> plans, const Store* store);

/// outlook() for these asks, with the measures that decide where `until` ends the stage. As long as
/// a checkpoint is undecided, its measures are read from the cache, or computed and cached, and
/// added to `measures`. Throws FilePruned or StoreDamaged, with the remedy, if a checkpoint that
/// may end the stage cannot be read.
Outlook measured_outlook(const Store& store, const Stage& stage, std::span<const Ask> asks,
                         std::span<const CheckpointRecord> checkpoints, KnownMeasures& measures,
                         const MeasureOptions& options);

/// The last cycle of the stage for one of its asks alone: Outlook::end. Throws as
/// measured_outlook().
double end_for(const Store& store, const Stage& stage, const Ask& ask,
               const MeasureOptions& options);

/// The checkpoints that were made and that at least one ask wants, each ask up to its end_for();
/// with pruned checkpoints.
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const Stage& stage,
                                              std::span<const Ask> asks,
                                              const MeasureOptions& options = {});

/// The recorded Outlook::ended of a stage that was completed before its last cycle, else null.
/// "cycles_asked" is added if the stage later went on to a length that another experiment asked
/// for.
nlohmann::json end_of(const Stage& stage);

/// "crystalline_percent >= 10 at cycle 25 and 15 more cycles"; "" for null.
std::string describe_end(const nlohmann::json& ended);

/// Mean cycle at which this `until` ended stages; nothing if it ended none.
std::optional<double> expected_end(std::span<const Stage> stages, const nlohmann::json& until);

// --- What it costs: estimates of memory, files and time ---

/// Memory [bytes] per grain that a run may need: grains, lists, wall grains, and a checkpoint while
/// it is written. Measured: 405 to 460 under shear (`bench speed`), 710 while 100,000 grains settle
/// (SCALING.md).
inline constexpr double kRunBytesPerGrain = 750;

/// Memory [bytes] that a whole run may need.
double run_bytes(const Geometry& shape);

/// Size [bytes] of the file of a checkpoint, estimated from its grains and wall grains.
double checkpoint_bytes(const Geometry& shape);

struct Rate {
  double particle_steps_per_second;  ///< of one core
  bool measured;                     ///< in the store's own runs; else assumed
};

/// Particle-steps/s of recorded runs.
class Rates {
 public:
  explicit Rates(const std::vector<Stage>& stages);

  /// The mean rate of the stage's engine in these runs; without such runs, the rate that was
  /// measured on another machine for this number of grains.
  Rate of(const Stage& stage) const;

 private:
  struct Sum {
    double steps = 0, seconds = 0;
  };
  std::map<EngineKind, Sum> sums_;
};

/// What is left of stages.
struct Work {
  std::size_t stages = 0;
  double particle_steps = 0;
  double bytes = 0;  ///< of checkpoint files
  double core_seconds = 0;
  double longest_seconds = 0;                ///< of the longest run, its packing included
  double rate = 0;                           ///< mean particle-steps/s of one core
  bool measured = true;                      ///< all rates were measured
  std::map<std::string, double> chain = {};  ///< seconds of a stage and its parents, by id

  /// Adds a stage; its parent must have been added before.
  void add(const Stage& stage, const Outlook& look, const Rates& rates);
  /// Wall time [s] if `at_a_time` stages are computed at once.
  double seconds(std::size_t at_a_time) const;
};

/// The stages with these ids, and those that they start from, down to their packings.
std::set<std::string> with_parents(const Store& store, const std::vector<std::string>& stages);

/// Whether nothing more is computed of the stage by itself: it failed, or cannot start because its
/// parent failed.
bool has_failed(const Store& store, const Stage& stage);

}  // namespace shearcell
