// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates the cost of stages before they run.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/filling.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/runner/asks.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// Memory [bytes] that a run may need per grain: grains, lists, wall grains, and a checkpoint while
/// it is written. Measured: 405 to 460 under shear (`bench speed`), 710 while 100,000 grains settle
/// (SCALING.md).
inline constexpr double kRunBytesPerGrain = 750;

/// Memory [bytes] that a whole run may need.
double run_bytes(const Geometry& shape);

/// Size [bytes] of the file of a checkpoint, estimated from its grains and wall grains.
double checkpoint_bytes(const Geometry& shape);

struct StageCost {
  double particle_steps = 0;
  double bytes = 0;  ///< of checkpoint files
};

/// Raises each target to the longest that the run was ever declared with, as `run` does. Returns
/// how many were raised.
std::size_t take_longer_targets(const std::vector<RunRecord>& known, Plan& plan);

/// The cycle from which the stage must be computed; nothing when it is done. `known` is its record
/// in `store`, or null. It is done when it has its length, or ended early by the same `until` of an
/// experiment that asked for at least this length; and when it has every checkpoint that was asked
/// for and that the planned run asks for. If checkpoints are missing: the cycle of the last one
/// before them.
std::optional<double> cycle_to_continue(const PlannedRun& run, const StageSpec& stage,
                                        const RunRecord* known, const Store* store);

/// Checkpoints that a shear or stiffen stage still records from `cycle` on, without the one at its
/// beginning. Phases at which it already recorded the cycle in progress are not counted.
double checkpoints_left(std::string_view kind, const RunAsk& ask, double cycle);

/// Cost of a planned stage from `cycle` on. Settling is estimated from what it took at N = 600 to
/// 18200; checkpoints by checkpoint_bytes.
StageCost stage_cost(const PlannedRun& run, const StageSpec& stage, double cycle);

struct Rate {
  double particle_steps_per_second;  ///< of one core
  bool measured;                     ///< in the store's own runs; else assumed
};

/// Particle-steps/s of recorded runs.
class Rates {
 public:
  explicit Rates(const std::vector<RunRecord>& runs);

  /// Mean over the runs of one engine. Without such runs, the rate that was measured on another
  /// machine for this number of grains.
  Rate of(EngineKind engine, double grains) const;

 private:
  struct Sum {
    double steps = 0, seconds = 0;
  };
  std::map<EngineKind, Sum> sums_;
};

/// What is left of stages.
struct RemainingWork {
  std::size_t stages = 0;
  double particle_steps = 0;
  double core_seconds = 0;
  double longest_seconds = 0;                ///< of the longest run, its packing included
  bool measured = true;                      ///< all rates were measured
  std::map<std::string, double> chain = {};  ///< seconds of a stage and its parents, by id

  /// Adds a stage, after its parent.
  void add(const std::string& id, const std::string& parent, double steps_left, const Rate& rate);
  /// Wall time [s] with so many stages at a time.
  double seconds(std::size_t at_a_time) const;
};

/// Ids of unfinished runs that cannot start, because the packing that they start from failed.
std::set<std::string> waiting_for_failed(const std::vector<RunRecord>& runs);

/// What is left of recorded stages, except those that failed or cannot start, at the rates of the
/// store's runs.
RemainingWork remaining_work(const Store& store, const std::vector<RunRecord>& stages);

}  // namespace shearcell
