// SPDX-License-Identifier: GPL-3.0-or-later
// Analysis of one packing. Its Voronoi cells, overlaps, crystallites and stress are computed once.
// Most measures are derived from them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "analysis/crystal.hpp"
#include "analysis/mechanics.hpp"
#include "analysis/packing_fraction.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// Measures of one packing, by their names. A mean over zero grains is NaN.
struct PackingMeasures {
  std::size_t grains = 0;               ///< N
  std::size_t interior_grains = 0;      ///< N_inves: grains at least 1.5 d from the wall surfaces
  double phi = 0;                       ///< volume fraction of interior grains, Eq. S4
  double phi_uncorrected = 0;           ///< phi_u, Eq. S2, of interior grains
  double crystalline_percent = 0;       ///< FCC and HCP grains among interior grains [%]
  double fcc_percent = 0;               ///< FCC grains among interior grains [%]
  double hcp_percent = 0;               ///< HCP grains among interior grains [%]
  double mean_overlap_d = 0;            ///< mean over touching pairs of grains, Eq. S3 [d]
  double contacts_per_grain = 0;        ///< mean number of contacts with grains and wall grains
  std::size_t crystallites = 0;         ///< number of crystallites of interior grains
  std::size_t largest_crystallite = 0;  ///< grains in the largest crystallite

  NLOHMANN_DEFINE_TYPE_INTRUSIVE(PackingMeasures, grains, interior_grains, phi, phi_uncorrected,
                                 crystalline_percent, fcc_percent, hcp_percent, mean_overlap_d,
                                 contacts_per_grain, crystallites, largest_crystallite)
};

/// Arrays with one entry per grain, in the order of grain ids.
struct GrainMeasures {
  VoronoiDiagram cells;
  Overlaps overlaps;
  std::vector<double> phi_local;
  std::vector<double> q6;
  std::vector<Structure> structure;       ///< also set for grains near the walls
  std::vector<std::uint8_t> interior;     ///< 1 for interior grains, else 0
  std::vector<std::int32_t> crystallite;  ///< crystallites() of crystalline interior grains
};

struct Analysis {
  PackingMeasures measures;
  Mechanics mechanics;
  GrainMeasures grains;
  CrystalliteMap crystallites;  ///< positions of the crystallites
};

/// Computes the measures of a packing and of each grain. Throws AnalysisError if voronoi() throws
/// it, or if the cell is less than 1 d deep.
Analysis analyse(const Checkpoint& checkpoint);

/// Mean of value_of(i) over the grains i that have selected[i] != 0 and a finite value_of(i). NaN
/// if there are no such grains.
double mean_over(std::span<const std::uint8_t> selected, const auto& value_of) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    const double value = selected[i] != 0 ? value_of(i) : std::nan("");
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return sum / count;
}

/// Percentage of the selected grains i for which holds(i) is true; NaN without selected grains.
double percent_of(std::span<const std::uint8_t> selected, const auto& holds) {
  return mean_over(selected, [&](std::size_t i) { return holds(i) ? 100 : 0; });
}

/// crystallites() of the crystalline interior grains. A Voronoi face connects two grains if its
/// area is at least `least_share` times the mean cell surface of interior grains.
std::vector<std::int32_t> crystallites_of(const GrainMeasures& grains, double least_share);

}  // namespace shearcell
