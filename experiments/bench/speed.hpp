// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the speed of the engine in a sheared cell, and the share of each part of the work.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace shearcell::bench {

/// Number of vector multiplications and fused multiply-adds per particle-step, with `lanes` grains
/// per vector and `slots` neighbour slots per block. Operations for walls, the periodic boundary in
/// z and the fluid are not counted.
double multiplications(std::size_t lanes, double slots);

/// Fused vector multiply-adds per second on one core: the largest of several short measurements.
/// `lanes`: number of doubles per vector; must be 1 or the width of one of kernels_here().
double peak_multiplications(std::size_t lanes);

struct SpeedOptions {
  std::vector<std::size_t> sizes = {600, 2000, 5200, 18200, 100000};
  std::vector<std::size_t> threads = {1};
  std::size_t repeats = 7;
  double seconds_per_repeat = 0.5;
  std::function<void(const std::string&)> report;  ///< receives progress messages; may be empty
};

/// Result for one size, one kernel and one number of threads. Rates are in 1e6 particle-steps/s.
struct SpeedResult {
  std::size_t grains = 0;
  std::string simd = {};
  std::size_t threads = 1;
  double median_rate = 0, slowest_rate = 0, fastest_rate = 0;
  /// Fractions of the total time. wall_share: contacts with wall planes, and contacts with grains
  /// of the moving wall. force_share: all other contacts. No fraction includes the drive, the wall
  /// movement, the sorting and the watchdog.
  double force_share = 0, integration_share = 0, wall_share = 0;
  double search_share = 0, prune_share = 0;  ///< search of outer lists, pruning of inner lists
  double steps_per_search = 0, steps_per_prune = 0;
  double bytes_per_grain = 0;
  double multiplications = 0;  ///< per particle-step
  /// Upper limit of the rate for this value of `multiplications`: the rate if the processor's
  /// multiplication units were never idle. The limit for one core is multiplied by `threads`.
  double limit = 0;
  std::string state_hash = {};  ///< hash after 200 steps; equal for all results of one size
};

/// Measures the speed for each size, kernel and number of threads. The cell has rough walls, the
/// parameters of Table I and A = 0.0833. The packing is first pressed together. For N > 18200 a
/// smaller packing is repeated along the depth; SpeedResult::grains includes all copies.
/// Throws std::runtime_error if kernels give different states after 200 steps. The fractions in
/// SpeedResult (force_share to prune_share) are always measured with one thread.
std::vector<SpeedResult> measure_speed(const SpeedOptions& options);

}  // namespace shearcell::bench
