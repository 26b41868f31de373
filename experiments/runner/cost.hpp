// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates of what stages cost: memory, files, time.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/filling.hpp"
#include "experiments/manifest/parameters.hpp"
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
  double core_seconds = 0;
  double longest_seconds = 0;                ///< of the longest run, its packing included
  bool measured = true;                      ///< all rates were measured
  std::map<std::string, double> chain = {};  ///< seconds of a stage and its parents, by id

  /// Adds a stage, after its parent.
  void add(const Stage& stage, double steps_left, const Rates& rates);
  /// Wall time [s] with so many stages at a time.
  double seconds(std::size_t at_a_time) const;
};

/// Ids of unfinished runs that cannot start, because the packing that they start from failed.
std::set<std::string> waiting_for_failed(const std::vector<Stage>& runs);

}  // namespace shearcell
