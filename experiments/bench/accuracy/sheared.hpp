// SPDX-License-Identifier: GPL-3.0-or-later
// What the time step does to many sheared grains: how soon two runs part, and what is left of the
// difference in means over seeds. And what soft grains do to the packing fraction.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/simulation.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell::accuracy {

/// A rough cell settled with Table I, and what acts on it under shear.
struct Packing {
  Parameters parameters;
  Cell cell;
  State state;  ///< at step 0
};

/// Throws NumericalFailure when it does not settle.
Packing settled(const Parameters& parameters, std::uint64_t seed);

/// Million particle-steps/s of the engine in this packing under shear on one thread: the median of
/// `repeats` stretches.
double shear_rate_measured(const Packing& packing, int repeats, double seconds_each);

/// Root mean square distance [d] of the grains from those of another run, against time [s].
struct Separation {
  double time_step = 0;  ///< [s]
  double wall_seconds = 0;
  std::vector<double> time, distance;
};

struct Chaos {
  std::vector<Separation> runs;  ///< from a run at 1/32 of Table I's time step
  Separation perturbed;          ///< from a run at Table I's, moved by 1e-13 d at the start
  double lyapunov_time = 0;      ///< [s], from its growth between 1e-11 and 1e-4 d; 0 if none
};

/// Shears the packing to `time` [s] with each number of steps per cycle, which must divide
/// 32 * 45600, and looks about `looks` times.
Chaos separate(const Packing& packing, const std::vector<std::uint64_t>& steps_per_cycle,
               double time, int looks);

/// Means over the ends of the cycles from `first_cycle` on.
struct RunMeans {
  double phi = 0, contacts = 0, overlap = 0;  ///< of Measures, overlap [d]
  std::string failure;                        ///< what the watchdog said; the means are then NaN
};

/// Shears a packing for `cycles` cycles.
RunMeans sheared_means(const Packing& packing, std::uint64_t steps_per_cycle, std::uint64_t cycles,
                       std::uint64_t first_cycle);

struct Softness {
  double stiffness_factor = 0;  ///< k/k_0
  double phi = 0, phi_uncorrected = 0, overlap = 0;
};

/// The packing at rest with k raised from k_0 to `decades` powers of ten above it, in quarters.
std::vector<Softness> stiffened(const Packing& packing, std::uint64_t decades);

}  // namespace shearcell::accuracy
