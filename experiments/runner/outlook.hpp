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

// --- Of the stages of a store or a plan ---

/// outlook() for all recorded asks. Nothing is measured: only recorded ends by `until` are known.
/// If an ask cannot be read, Outlook::unreadable says why.
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

// --- What it costs: estimates of memory, files and time ---

/// Memory [bytes] that a run may need per grain: grains, lists, wall grains, and a checkpoint while
/// it is written. Measured: 405 to 460 under shear (`bench speed`), 710 while 100,000 grains settle
/// (SCALING.md).
inline constexpr double kRunBytesPerGrain = 750;

/// Memory [bytes] that a whole run may need.
double run_bytes(const Geometry& shape);

/// Size [bytes] of the file of a checkpoint, estimated from its grains and wall grains.
double checkpoint_bytes(const Geometry& shape);

/// Simulated time [s] that a packing takes to settle; within a third of the measured 0.9, 1.1, 1.6
/// and 2.8 s at N = 600, 2000, 5200 and 18200.
double settling_time_s(const Parameters& parameters);

/// Evaluations of the forces in one minimization at the default tolerance, on average over the nine
/// of B.2; within a sixth of the measured 8.2e3, 16e3 and 52e3 at N = 600, 2000 and 7900.
double minimization_evaluations(double grains);

struct Rate {
  double particle_steps_per_second;  ///< of one core
  bool measured;                     ///< in the store's own runs; else assumed
};

/// Particle-steps/s of recorded runs.
class Rates {
 public:
  explicit Rates(const std::vector<Stage>& runs);

  /// Mean over the runs of the stage's engine. Without such runs, the rate that was measured on
  /// another machine for this number of grains.
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

  /// Adds a stage, after its parent.
  void add(const Stage& stage, const Outlook& look, const Rates& rates);
  /// Wall time [s] with so many stages at a time.
  double seconds(std::size_t at_a_time) const;
};

/// Ids of unfinished runs that cannot start, because the packing that they start from failed.
std::set<std::string> waiting_for_failed(const std::vector<Stage>& runs);

}  // namespace shearcell
