// SPDX-License-Identifier: GPL-3.0-or-later
// Where in the cell nuclei appear (supplement E), and how often: events per grain and cycle versus
// phi, and how this rate grows with the number of grains. The supplement does not give the rate.
// The rate tests whether nucleation is homogeneous: nucleation in the bulk is proportional to the
// volume, and nucleation at walls is proportional to the area of the walls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "analysis/claims.hpp"

namespace shearcell {

/// Axis of a position. A height is divided by the current height of the cell (`y`) or by 1.675 L
/// (`y_nominal`), where L is the free width.
enum class CellAxis { x, y, y_nominal };
inline constexpr double nominal_height = 1.675;  ///< [L], supplement E

/// Whether a nucleus counts in each cycle (`always`) or only in the cycle in which it is first seen
/// (`first`). A crystallite of at least 15 grains is a new nucleus if fewer than half of its grains
/// were in crystallites of at least 15 grains at earlier checkpoints. A new nucleus of more than
/// 25 grains is left out. [choice]
enum class Seen { always, first };

/// Positions along `axis` of the centres of mass of all crystallites of 15 to 25 grains in a run.
/// x is measured from 1 d outside the left plane, in units of width + 2 d. y and y_nominal are
/// measured from the bottom plane, in units of the heights that CellAxis states. x and y are in
/// [0, 1]; y_nominal can exceed 1. The supplement leaves these definitions open.
std::vector<double> nucleus_places(const FrameRun& run, CellAxis axis, Seen seen = Seen::always);

struct DensityBin {
  double low = 0;
  double high = 0;
  double density = 0;           ///< P; its integral over [0, 1] is 1
  std::optional<double> error;  ///< by bootstrap over groups, see density()
};

/// Density of all positions together; empty without positions. Each group has the positions of one
/// packing. The bootstrap draws whole groups, which must be independent. The positions in a group
/// are not independent, because one crystallite is seen at many cycles.
std::vector<DensityBin> density(std::span<const std::vector<double>> groups, std::size_t bins);

/// The region of a nucleation rate. The rate is the number of events per cycle and per grain of the
/// region, as a function of the phi of the region. The grains of the region are at least 1.5 d
/// (interior) or 4 d (core) from the wall surfaces (packing_fraction.hpp). An event is the onset
/// of a run by method 1 (onset.hpp), which does not depend on the region.
enum class Region { interior, core };
/// Name of the measure that counts the grains of the region.
std::string grains_of(Region region);

/// Nucleation rate in a bin of phi (phi_bin) before the onset (onset.hpp, method 1).
struct NucleationRate {
  double phi_low = 0;
  double phi_high = 0;
  std::size_t events = 0;   ///< number of onsets
  double grain_cycles = 0;  ///< sum over runs: (grains in the region) x (cycles without onset)
  double rate = 0;          ///< events per grain and cycle
  Interval interval;        ///< from the Poisson count: F. Garwood, Biometrika 28, 437 (1936)
};

/// Rates in ascending bins of phi. Bins in which no run spent time are left out. The time between
/// two checkpoints counts in the bin of the first checkpoint, because at this checkpoint a growing
/// crystallite has not yet raised phi. Runs that begin with a critical crystallite are left out.
std::vector<NucleationRate> nucleation_rates(RunGroup runs, Region region);

/// Contribution of one run to the rate in one range of phi: the time that the run spends in this
/// range before its onset.
struct Exposure {
  double phi = 0;  ///< mean over the cycles
  double cycles = 0;
  double grain_cycles = 0;  ///< number of grains in the region, times cycles
  std::size_t onsets = 0;   ///< 0 or 1
};
/// The exposure of a run in each range of phi. Range k begins at phi = k times `width`.
std::map<std::int64_t, Exposure> exposures_of(const FrameRun& run, Region region, double width);

/// Width of the ranges of phi in which size_exponent() treats the rate as constant.
inline constexpr double rate_step = 0.0005;

/// Maximum-likelihood estimate of the exponent a in rate = c(amplitude, phi) n^a, where n is the
/// number of grains in the region. Onsets are a Poisson process, and ln c is a parabola in phi for
/// each amplitude. A run counts until its onset. The interval comes from the profile likelihood, as
/// is usual for such data (D. R. Cox and D. Oakes, Analysis of Survival Data, 1984). The interval
/// contains all exponents whose log-likelihood is at most a certain amount below the maximum. If
/// runs share a packing, this amount is multiplied by a factor of at least 1: the variance of the
/// packings' scores, divided by the variance expected for independent runs (L. Pace, A. Salvan, N.
/// Sartori, Stat. Sinica 21, 129 (2011)).
///
/// Empty if the runs have fewer than least_runs different packings. Also empty unless at least one
/// onset has a comparison run in a cell of fewer grains, and at least one onset has a comparison
/// run in a cell of more grains. A comparison run has the same amplitude, and has a phi within
/// phi_bin of the phi of the onset.
std::optional<Estimate> size_exponent(RunGroup runs, Region region,
                                      double level = confidence_level);

}  // namespace shearcell
