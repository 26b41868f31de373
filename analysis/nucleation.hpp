// SPDX-License-Identifier: GPL-3.0-or-later
// Where in the cell crystallites near the critical size appear (supplement E), and how often:
// events per grain and cycle against phi, and how the rate grows with the number of grains. The
// rate is not in the supplement, whose title it tests: nucleation in the bulk is proportional to
// the volume, nucleation at walls to their area.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "analysis/claims.hpp"

namespace shearcell {

/// Heights are relative to the cell's present height (`y`) or to 1.675 L (`y_nominal`), with L the
/// free width.
enum class CellAxis { x, y, y_nominal };
inline constexpr double nominal_height = 1.675;  ///< [L], supplement E

/// Whether a nucleus counts in every cycle, or once, where it is first seen. A crystallite of 15
/// grains or more is a new nucleus if fewer than half of its grains have been in nuclei before, at
/// any cycle. A nucleus that is first seen with more than 25 grains has no place. [choice]
enum class Seen { always, first };

/// Places of the centres of mass of the crystallites of 15 to 25 grains in a run. x is counted from
/// d outside the left plane in units of w = width + 2 d, y from the bottom plane in units of the
/// height h, so that both lie in [0, 1]; a cell higher than 1.675 L exceeds that. [choice]
std::vector<double> nucleus_places(const FrameRun& run, CellAxis axis, Seen seen = Seen::always);

struct DensityBin {
  double low = 0;
  double high = 0;
  double density = 0;           ///< P; its integral over [0, 1] is 1
  std::optional<double> error;  ///< bootstrap, as one crystallite is seen many times
};

/// Density of all places together; empty without places. Each group has the places of one packing.
/// The bootstrap draws groups, which must be independent.
std::vector<DensityBin> density(std::span<const std::vector<double>> groups, std::size_t bins);

/// The grains whose number and phi a rate is taken with: at least 1.5 d (interior) or 4 d (core)
/// from the wall surfaces (packing_fraction.hpp). The onset is the same for both.
enum class Region { interior, core };
/// Name of the measure that counts the grains of the region.
std::string grains_of(Region region);

/// A bin of phi (binning.hpp) before the onset of crystallization (onset.hpp, method 1).
struct NucleationRate {
  double phi_low = 0;
  double phi_high = 0;
  std::size_t events = 0;   ///< onsets that began in the bin
  double grain_cycles = 0;  ///< grains of the region times cycles without an onset, over all runs
  double rate = 0;          ///< events per grain and cycle
  Interval interval;  ///< of the rate; of a Poisson count, F. Garwood, Biometrika 28, 437 (1936)
};

/// Rates in ascending bins of phi; bins in which no run spent time are left out. An interval
/// between two checkpoints counts in the bin of phi at its beginning, which a growing crystallite
/// has not raised yet. Runs that begin with a critical crystallite do not count.
std::vector<NucleationRate> nucleation_rates(RunGroup runs, Region region);

/// What one run adds to a rate while phi is in a range, before its onset.
struct Exposure {
  double phi = 0;  ///< mean over the cycles
  double cycles = 0;
  double grain_cycles = 0;  ///< grains of the region times cycles
  std::size_t onsets = 0;   ///< 0 or 1
};
/// Exposures of a run in ranges of phi: range k begins at k times `width`.
std::map<std::int64_t, Exposure> exposures_of(const FrameRun& run, Region region, double width);

/// Ranges of phi in which size_exponent() takes the rate as constant.
inline constexpr double rate_step = 0.0005;

/// The exponent a of rate = c(amplitude, phi) n^a, n the grains of the region, by maximum
/// likelihood: onsets are a Poisson process, and ln c is a parabola in phi for each amplitude.
/// Interval of the profile likelihood, since a run has one event at most (D. R. Cox and D. Oakes,
/// Analysis of Survival Data, 1984). If runs share a packing, the drop of the logarithm that the
/// interval allows is multiplied by the ratio of the variance of the score between packings to that
/// between independent runs, where that is larger than 1 (L. Pace, A. Salvan, N. Sartori, Stat.
/// Sinica 21, 129 (2011)). Empty for fewer than least_runs packings. Empty also unless runs of
/// larger cells (more grains N) were at about the phi of some event, and runs of smaller cells at
/// about the phi of some event.
std::optional<Estimate> size_exponent(RunGroup runs, Region region,
                                      double level = confidence_level);

}  // namespace shearcell
