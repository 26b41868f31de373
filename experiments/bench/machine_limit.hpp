// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the kernel could run at most on this machine: its counted operations at the measured
// peak of the vector units, and its counted bytes at the measured speed of reading.
//
// Peak: a loop of independent fused multiply-adds, additions and shuffles of doubles in registers,
// 4 : 2 : 3 as in the kernel. Reading: sums over an array as large as the one that a time step
// passes through, so from the cache that holds it, or from memory. Both are the best of several
// short runs on one core.
#pragma once

#include <cstddef>

namespace shearcell::bench {

/// What one particle-step does at least.
struct StepWork {
  double vector_operations = 0;  ///< arithmetic and shuffles; loads and stores are not counted
  double bytes = 0;              ///< read and written in arrays over grains; each row counts once
};

/// Work of a kernel with `lanes` grains per vector and `slots` neighbour slots per block, averaged.
StepWork step_work(std::size_t lanes, double slots);

/// Bytes per grain of all arrays that a time step passes through.
double step_footprint(std::size_t lanes, double slots);

/// Vector operations per second in vectors of `lanes` doubles: 8, 4 or 2 as find_kernels() offers
/// them, 1 for scalars.
double peak_operations(std::size_t lanes);

/// Bytes per second read from an array of `bytes`.
double read_bandwidth(std::size_t bytes);

}  // namespace shearcell::bench
