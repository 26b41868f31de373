// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a packing from loose grains. The moving wall presses the grains together. Then the grains
// come to rest under gravity and the load.
#pragma once

#include "protocols/protocol.hpp"

namespace shearcell {

/// Largest number of time steps of a stage. A double holds all whole numbers up to this number.
inline constexpr double kMostSteps = 1e15;

/// Time between two checks of a settling packing [s].
inline constexpr double kSettleCheckInterval = 0.1;

struct SettleParameters {
  double force_tolerance = 1e-3;    ///< largest |load - contact force| / (P A_w) of the moving wall
  double kinetic_tolerance = 1e-8;  ///< largest kinetic energy per grain, divided by P d^3
  double time_limit = 60;           ///< largest settling time [s]; a longer time is an error
  double overlap_limit =
      WatchdogLimits{}.overlap;  ///< overlap limit after the grains are pressed together [d]
};

/// Estimated time [s] that the moving wall needs to press loose grains into a dense packing, plus
/// half a second. The wall is assumed to move at the speed at which the drag on the wall and on all
/// grains balances the pressure. The loose grains fill `height` [d]; `per_area`: grains per d^2.
double pressing_time(const Scene& scene, double height, double per_area);

/// Gravity is switched on only after the moving wall has pressed the grains together. With gravity
/// from the start, the grains would form a heap, which a moving bottom wall must lift. If the
/// weight of the heap is nearly the load P A_w (the weight is 0.95 P A_w at N = 18200), the heap
/// jams between rough side walls before it reaches the top wall.
///
/// Under gravity, the packing is checked every 0.1 s. It has settled when three numbers are below
/// their tolerances: the force imbalance of the moving wall, the drag force B_w y' on this wall
/// (both divided by P A_w), and the kinetic energy per grain. The drag force is checked so that a
/// slowly creeping wall does not count as balanced.
///
/// While the wall presses, overlaps up to half a diameter are allowed: a grain may be caught
/// between grains of the moving wall and of a side wall, and then carries the whole load.
class Settle {
 public:
  /// `scene` is the scene after gravity is switched on.
  Settle(const SettleParameters& parameters, const Scene& scene);
  /// See Protocol::advance.
  StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const;

  /// Number of time steps in pressing_time(), rounded up to a multiple of the check interval. It is
  /// at most the number of steps in the time limit. Without pressure it is 0.
  std::uint64_t compaction_steps(const Cell& cell, std::size_t grains) const;

  /// Number of steps before gravity is switched on: compaction_steps(), or 0 for a scene without
  /// gravity.
  std::uint64_t steps_without_gravity(const Cell& cell, std::size_t grains) const;

  /// The first step after `step` at which the tolerances are checked.
  std::uint64_t next_check(std::uint64_t step) const;

 private:
  /// Returns true if the tolerances are checked at this step and the packing has settled. Throws
  /// NumericalFailure at the first check after the time limit.
  bool finished(const Simulation& simulation) const;
  bool settled(const Simulation& simulation) const;

  SettleParameters parameters_;
  Scene scene_;
  std::uint64_t check_steps_;
  std::uint64_t limit_steps_;
};

/// Presses the grains together without gravity for pressing_time(). The result is a dense packing
/// at step 0 that is not yet at rest.
State pressed(const Cell& cell, const State& loose, Scene scene);

}  // namespace shearcell
