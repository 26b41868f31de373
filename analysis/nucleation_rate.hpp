// SPDX-License-Identifier: GPL-3.0-or-later
// How often a cell nucleates: events per grain and cycle against phi, and how the rate grows with
// the number of grains. Not in the supplement, whose title it tests: nucleation in the bulk is
// proportional to the volume, nucleation at walls to their area.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "analysis/claims.hpp"

namespace shearcell {

/// A bin of phi (binning.hpp) before the onset of crystallization (onset.hpp, method 1).
struct NucleationRate {
  double phi_low = 0;
  double phi_high = 0;
  std::size_t events = 0;   ///< onsets that began in the bin
  double grain_cycles = 0;  ///< interior grains times cycles without an onset, over all runs
  double rate = 0;          ///< events per grain and cycle
  Interval interval;  ///< of the rate; of a Poisson count, F. Garwood, Biometrika 28, 437 (1936)
};

/// Ascending; bins in which some run spent time. The phi of an interval between two checkpoints is
/// that of its beginning, so that a growing crystallite does not raise it. Runs that begin with a
/// critical crystallite do not count.
std::vector<NucleationRate> nucleation_rates(RunGroup runs);

/// The exponent a of rate = c(amplitude, phi) N_inves^a, by maximum likelihood: onsets are a
/// Poisson process with a constant c in each bin of phi at each amplitude. Interval by bootstrap
/// over runs. None if no bin with an event has runs of two sizes, or for fewer than least_runs
/// runs.
std::optional<Estimate> size_exponent(RunGroup runs);

}  // namespace shearcell
