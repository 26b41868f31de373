// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the engine in the sheared scene: particle-steps per second and the share of each part.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace shearcell::bench {

// Upper limits of the kernel's speed on this machine: its counted operations at the measured peak
// of the vector units, and its counted bytes at the measured read bandwidth.
//
// Peak: a loop of independent fused multiply-adds, additions and shuffles of doubles in registers,
// 4 : 2 : 3 as in the kernel. Bandwidth: a search through an array as large as those that a time
// step reads, so from the cache that holds it, or from memory. Both are the best of several short
// runs on one core.

/// The least work of one particle-step.
struct StepWork {
  double vector_operations = 0;  ///< arithmetic and shuffles; loads and stores are not counted
  double bytes = 0;              ///< read and written in arrays over grains; each row counts once
  double footprint = 0;  ///< bytes of these arrays; the velocity is written where it was read
};

/// Mean work of a kernel with `lanes` grains per vector and `slots` neighbour slots per block.
StepWork step_work(std::size_t lanes, double slots);

/// Vector operations per second in vectors of `lanes` doubles: 8, 4 or 2 as kernels_here() offers
/// them, 1 for scalars.
double peak_operations(std::size_t lanes);

/// Bytes per second read from an array of `bytes`.
double read_bandwidth(std::size_t bytes);

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
  /// The least work of a particle-step, and the rates that this machine's vector units and its
  /// caches or memory allow: measured on one core and multiplied by the threads.
  StepWork work = {};
  double arithmetic_limit = 0, memory_limit = 0;
  std::string state_hash = {};  ///< after 200 steps; the same for all results of one size
};

/// Table I in a rough cell sheared at A = 0.0833, from a packing pressed together first. Beyond
/// N = 18200 a smaller packing is repeated along the depth, so the cell becomes deeper and not
/// higher; the result has the N of the repeated packing. Before anything is timed every
/// kernel must give the same state after 200 steps; otherwise std::runtime_error is thrown. Shares
/// are measured with one thread.
std::vector<SpeedResult> measure_speed(const SpeedOptions& options);

}  // namespace shearcell::bench
