// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the engine in the sheared scene: particle-steps per second and the share of each part.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace shearcell::bench {

/// Multiplications and fused multiply-adds of one particle-step, in vectors of `lanes` grains with
/// `slots` neighbour slots per block. Only those that the kernel cannot do without are counted:
/// none for walls, the seam in z, or the fluid.
double multiplications(std::size_t lanes, double slots);

/// Fused multiply-adds per second of one core, in vectors of `lanes` doubles: 8, 4 or 2 if
/// kernels_here() has them, 1 for scalars. The fastest of several short runs that do nothing else.
double peak_multiplications(std::size_t lanes);

struct SpeedOptions {
  std::vector<std::size_t> sizes = {600, 2000, 5200, 18200, 100000};
  std::vector<std::size_t> threads = {1};
  std::size_t repeats = 7;
  double seconds_per_repeat = 0.5;
  std::function<void(const std::string&)> report;  ///< progress messages; may be empty
};

/// One size with one kernel and one number of threads. Rates are in 1e6 particle-steps/s.
struct SpeedResult {
  std::size_t grains = 0;
  std::string simd = {};
  std::size_t threads = 1;
  double median_rate = 0, slowest_rate = 0, fastest_rate = 0;
  /// Shares of the time. Walls: planes and the moving wall's grains; grains of the other walls
  /// count as neighbours under forces. The rest: moving wall, drive, sorting, watchdog.
  double force_share = 0, integration_share = 0, wall_share = 0;
  double search_share = 0, prune_share = 0;  ///< of the outer list, of the inner list
  double steps_per_search = 0, steps_per_prune = 0;
  double bytes_per_grain = 0;
  double multiplications = 0;  ///< per particle-step
  /// The rate if the multiplication units were never idle: measured on one core and multiplied by
  /// the threads. No kernel with these operations can exceed it.
  double limit = 0;
  std::string state_hash = {};  ///< after 200 steps; the same for all results of one size
};

/// Table I in a rough cell sheared at A = 0.0833, from a packing pressed together first. Beyond
/// N = 18200 a smaller packing is repeated along the depth, so the cell becomes deeper and not
/// higher; the result has the N of the repeated packing. Before anything is timed every
/// kernel must give the same state after 200 steps; otherwise std::runtime_error is thrown. Shares
/// are measured with one thread.
std::vector<SpeedResult> measure_speed(const SpeedOptions& options);

}  // namespace shearcell::bench
