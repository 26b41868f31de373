// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of an integrator in a vibrating crystal, where every frequency is known.
#pragma once

#include "experiments/bench/accuracy/integrate.hpp"

namespace shearcell::accuracy {

/// Frequencies [rad/s] of the waves along [001] in a periodic crystal whose neighbours overlap by
/// `overlap`, q in units of 1/d; p = overlap/(1 - overlap) is the pre-stress of a contact and
/// h = (1 - overlap)/sqrt(2) the distance of two layers:
///   longitudinal  w^2 = 8 (k/m) (1 - p) sin^2(q h/2),   transverse  4 (k/m) (1 - 3 p) sin^2(q
///   h/2).
double fcc_longitudinal(const Scene& scene, double overlap, double q);
double fcc_transverse(const Scene& scene, double overlap, double q);
/// The same of the longitudinal waves of a row, 2 sqrt(k/m) |sin(q (1 - overlap)/2)|.
double chain_longitudinal(const Scene& scene, double overlap, double q);

/// Frequency [rad/s] with which a method lets the crystal vibrate in a shape (3N numbers): from
/// cos(w dt) = sum x_n (x_(n+1) + x_(n-1)) / (2 sum x_n^2) over its projections x_n at `steps`
/// steps, at an amplitude of 1e-6 d. Without drag.
double measured_frequency(const Crystal& crystal, const Eigen::VectorXd& shape,
                          const Method& method, double dt, std::uint64_t steps);

/// Largest relative error of the frequency over `count` modes from the lowest above zero to the
/// highest.
double frequency_error(const Crystal& crystal, const Method& method, double dt, int count,
                       std::uint64_t steps);

/// A crystal at rest whose grains get random velocities: root mean square `speed` [d/s], no total
/// momentum along z. `seed` makes another one.
Motion shaken(const Crystal& crystal, double speed, std::uint64_t seed);

struct DriftResult {
  /// Change of the energy of vibration over the whole time, by a straight line through the means of
  /// a hundred equal stretches, over its mean.
  double drift = 0;
  double scatter = 0;   ///< standard deviation of those means from the line, over the same
  double momentum = 0;  ///< largest |sum of v_z| over the sum of |v_z|
};

/// Without drag, for `steps` time steps.
DriftResult energy_drift(const Crystal& crystal, const Motion& start, const Method& method,
                         double dt, std::uint64_t steps);

/// Root mean square distance [d] of the positions from those of PEFRL at dt/32, with drag, at the
/// time step's multiple nearest to `time` [s].
double trajectory_error(const Crystal& crystal, const Motion& start, const Method& method,
                        double dt, double time);

}  // namespace shearcell::accuracy
