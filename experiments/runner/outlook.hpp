// SPDX-License-Identifier: GPL-3.0-or-later
// What remains to be computed of a stage, and what that costs. All commands use outlook().
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

/// Scalar measures of checkpoints, by the checkpoint's SHA-256.
using KnownMeasures = std::map<std::string, Measures>;

struct Outlook {
  /// Whether the stage is completed, is long enough for all requests, and lacks no checkpoint.
  bool done = false;
  /// Steps, ascending, at which an experiment requests a checkpoint, but which the stage has passed
  /// without recording a checkpoint. A replay can compute these checkpoints. Empty for LAMMPS,
  /// whose runs cannot be replayed bit for bit.
  std::vector<std::uint64_t> missing = {};
  /// The cycle at which the stage ends: the largest number of cycles that experiments ask for, or
  /// an earlier cycle at which `until` is known to end the stage.
  double end = 0;
  /// Whether an `until` that is not fulfilled yet may end the stage before `end`.
  bool may_end_early = false;
  /// Null, or how an `until` ended the stage at its last checkpoint, in the form of the event
  /// RunCompleted: {"by": "until", "measure", "value", "extra_cycles", "reached_at_cycle",
  /// "memberships"}.
  nlohmann::json ended = nullptr;
  /// The first checkpoint that may fulfil an `until`, but was not measured yet.
  std::optional<CheckpointRecord> undecided = {};
  // The remaining work: upper bounds for a shear, estimates for other kinds of stages.
  double checkpoints = 0;
  double particle_steps = 0;
  double bytes = 0;  ///< estimated size of the checkpoint files
  /// Why this program cannot read the stage's parameters, or "". If set, the remaining work is
  /// unknown.
  std::string unreadable = {};
};

/// Finds what remains to be computed of a recorded or a new stage. `asks`: the requests of
/// experiments, which may differ from the recorded requests in `stage`. `checkpoints`: all
/// checkpoints of the stage except rejected ones, by step (Listed::and_pruned). Let R be a request
/// with an `until`. A completed stage needs no more cycles for R if a recorded request has the same
/// `until` as R, at least as many cycles, and a `checkpoint_every` that is a multiple of R's
/// `checkpoint_every`. This recorded request tests `until` only at cycles at which R tests `until`,
/// so it cannot end the stage earlier than R would. Throws StoreDamaged if a request is invalid.
Outlook outlook(const Stage& stage, std::span<const Ask> asks,
                std::span<const CheckpointRecord> checkpoints, const KnownMeasures& measures = {});

/// Motion of the walls in a shear stage. Empty for other kinds of stages, and for a stage with an
/// unreadable record, which `verify` reports.
std::optional<Drive> shear_drive(const Stage& stage);

/// The checkpoint schedule of a shear: one entry for each request, except requests for 0 cycles.
/// Throws StoreDamaged if a request is invalid.
std::vector<CheckpointCadence> cadences_of(const Stage& stage, std::span<const Ask> asks,
                                           const Drive& drive);

/// The requested checkpoints of a stage: those at the intervals, the phases and the last cycle of
/// each request. Checkpoints that were recorded only because of an interruption or another
/// experiment are excluded, so that figures and tables do not depend on them.
struct AskedCheckpoints {
  std::vector<CheckpointRecord> made = {};
  /// Steps, ascending, at which a checkpoint is requested, but which the stage has passed without
  /// recording one; at most a million steps.
  std::vector<std::uint64_t> missing = {};
  double to_come = 0;  ///< number of checkpoints not reached yet; an estimate if above 10,000
};

/// The checkpoints that `asks` request from cycle `first` to `last`. `checkpoints`: as for
/// outlook(). If the stage is not a shear or `asks` is empty: the checkpoints at whole cycles.
AskedCheckpoints asked_checkpoints(const Stage& stage, std::span<const Ask> asks,
                                   std::span<const CheckpointRecord> checkpoints, double first = 0,
                                   double last = StoreLimits::cycles);

/// Greatest common divisor of the checkpoint intervals [cycles] of all requests.
std::uint64_t checkpoint_cadence(std::span<const Ask> asks);

// --- Outlooks of the stages of a store or a plan ---

/// outlook() for all recorded requests. Measures nothing: an `until` counts as reached only if the
/// store has recorded that it was reached. Sets Outlook::unreadable if a request cannot be read.
Outlook look_at(const Store& store, const Stage& stage);

/// A stage needed by the runs of one or more plans, with what the store records about this stage.
struct PlannedStage {
  const PlannedRun* run = nullptr;  ///< the first run with this stage
  Stage stage = {};
  std::vector<Membership> memberships = {};  ///< from the store, then from the plans
  std::vector<CheckpointRecord> checkpoints = {};
  Outlook look = {};
};

/// The outlook of each stage that the plans need: each stage once, parents first. `store` may be
/// null. Throws StoreDamaged like outlook().
std::vector<PlannedStage> look_at(std::span<const Plan> plans, const Store* store);

/// outlook() with all measures that decide where `until` ends the stage. Missing measures are read
/// from the cache, or computed and cached, and added to `measures`. Throws FilePruned or
/// StoreDamaged, with the remedy, if a checkpoint that may end the stage cannot be read.
Outlook measured_outlook(const Store& store, const Stage& stage, std::span<const Ask> asks,
                         std::span<const CheckpointRecord> checkpoints, KnownMeasures& measures,
                         const MeasureOptions& options);

/// The cycle at which the stage ends if only this request is considered (Outlook::end). Throws like
/// measured_outlook().
double end_for(const Store& store, const Stage& stage, const Ask& ask,
               const MeasureOptions& options);

/// The checkpoints that are covered by at least one request in `asks`, including pruned
/// checkpoints. A request covers no checkpoint after the end_for() of this request.
std::vector<CheckpointRecord> checkpoints_for(const Store& store, const Stage& stage,
                                              std::span<const Ask> asks,
                                              const MeasureOptions& options = {});

/// The recorded Outlook::ended if the stage ended before `target_cycles` because of an `until`;
/// otherwise null. If a request with another or no `until` made the stage continue further, the
/// result also has "cycles_asked": the target_cycles of this request.
nlohmann::json end_of(const Stage& stage);

/// end_of() as text: "crystalline_percent >= 10 at cycle 25, then 15 more cycles"; "" for null.
std::string describe_end(const nlohmann::json& ended);

/// Mean cycle at which this `until` ended stages; empty if it ended no stage.
std::optional<double> expected_end(std::span<const Stage> stages, const nlohmann::json& until);

// --- Estimates of memory, file sizes and time ---

/// Memory [bytes] per grain that a run may need for its grains, neighbour lists and wall grains,
/// and for a checkpoint while it is written. Measured: 405 to 460 under shear (`bench speed`), 710
/// while 100,000 grains settle (SCALING.md).
inline constexpr double kRunBytesPerGrain = 750;

/// Memory [bytes] that a whole run may need.
double run_bytes(const Geometry& shape);

/// Size [bytes] of a checkpoint file, estimated from the numbers of grains and wall grains.
double checkpoint_bytes(const Geometry& shape);

struct Rate {
  double particle_steps_per_second;  ///< of one core
  bool measured;                     ///< whether the rate is a mean of recorded runs
};

/// Mean rates of recorded runs [particle-steps/s].
class Rates {
 public:
  explicit Rates(const std::vector<Stage>& stages);

  /// The mean rate of the recorded runs that used the stage's engine. If these runs took less than
  /// 1 s in total: a rate measured on another machine, interpolated to the number of grains.
  Rate of(const Stage& stage) const;

 private:
  std::map<EngineKind, Effort> sums_;  // over the stages of each engine
};

/// The remaining work of several stages.
struct Work {
  std::size_t stages = 0;
  double particle_steps = 0;
  double bytes = 0;  ///< of checkpoint files
  double core_seconds = 0;
  double longest_seconds = 0;                ///< largest value of `chain` [s]
  double rate = 0;                           ///< mean particle-steps/s of one core
  bool measured = true;                      ///< false if any rate was assumed
  std::map<std::string, double> chain = {};  ///< by stage id: total time [s] with all parents

  /// Adds a stage; its parent must have been added before.
  void add(const Stage& stage, const Outlook& look, const Rates& rates);
  /// Wall time [s] if `at_a_time` stages are computed at once.
  double seconds(std::size_t at_a_time) const;
};

/// The ids of these stages and of all their parents, down to the packings.
std::set<std::string> with_parents(const Store& store, const std::vector<std::string>& stages);

/// Whether the stage failed, or cannot start because its parent failed.
bool has_failed(const Store& store, const Stage& stage);

}  // namespace shearcell
