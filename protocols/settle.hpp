// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a packing from loose grains: presses them together, then lets them come to rest under
// gravity and the load.
#pragma once

#include "protocols/protocol.hpp"

namespace shearcell {

/// Largest number of time steps of a stage. A double represents every whole number up to it.
inline constexpr double kMostSteps = 1e15;

/// Time between checks of whether a packing has settled [s].
inline constexpr double kSettleCheckInterval = 0.1;

struct SettleParameters {
  double force_tolerance = 1e-3;    ///< largest |load - contact force| / (P A_w) of the moving wall
  double kinetic_tolerance = 1e-8;  ///< largest kinetic energy per grain over P d^3
  double time_limit = 60;           ///< [s]; a packing that takes longer is an error
  double overlap_limit =
      WatchdogLimits{}.overlap;  ///< of the watchdog, after the wall has pressed the grains [d]
};

/// Time [s] for which the moving wall presses loose grains together: until they are dense, and half
/// a second more. The wall is assumed to move at the speed at which its drag and the drag of all
/// grains balance the pressure. The loose grains are `height` [d] high, with `per_area` grains per
/// d^2 of wall.
double pressing_time(const Scene& scene, double height, double per_area);

/// Gravity is switched on only after the moving wall has had time to press the grains together.
/// Grains that fall first form a heap, and a heap nearly as heavy as P A_w (0.95 of it at N =
/// 18200) jams between rough side walls before it reaches the top.
///
/// The packing has settled when three numbers are below their tolerances, at a check every 0.1 s
/// under gravity: the force imbalance of the moving wall, its drag force B_w y' (both over P A_w),
/// and the kinetic energy per grain. The drag force is checked so that a creeping wall does not
/// count as balanced.
///
/// While the wall presses, overlaps up to half a diameter are accepted: the wall may catch a grain
/// between its own wall grains and those of a side wall, and push the grain out with the whole
/// load.
class Settle {
 public:
  /// `scene` is the scene with gravity.
  Settle(const SettleParameters& parameters, const Scene& scene);
  /// See Protocol::advance.
  StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const;

  /// pressing_time() in steps, a multiple of the check interval, at most the time limit. 0 without
  /// pressure.
  std::uint64_t compaction_steps(const Cell& cell, std::size_t grains) const;

  /// The compaction steps before gravity is switched on: all of them, or 0 if the scene has no
  /// gravity.
  std::uint64_t steps_without_gravity(const Cell& cell, std::size_t grains) const;

  /// The first step after `step` at which the tolerances are checked.
  std::uint64_t next_check(std::uint64_t step) const;

 private:
  /// Whether the packing has settled, at a check. Throws NumericalFailure at a check after the time
  /// limit.
  bool finished(const Simulation& simulation) const;
  bool settled(const Simulation& simulation) const;

  SettleParameters parameters_;
  Scene scene_;
  std::uint64_t check_steps_;
  std::uint64_t limit_steps_;
};

/// Presses the grains together without gravity for as long as Settle does. The result is a dense
/// packing that has not come to rest, at step 0.
State pressed(const Cell& cell, const State& loose, Scene scene);

}  // namespace shearcell
