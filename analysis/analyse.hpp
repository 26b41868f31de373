// SPDX-License-Identifier: GPL-3.0-or-later
// The analysis of one packing: its Voronoi cells, overlaps, crystallites and stress are computed
// once, and most measures follow from them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/crystal.hpp"
#include "analysis/mechanics.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// Measures of one packing. A mean over no grain is not a number.
struct PackingMeasures {
  std::size_t grains = 0;               ///< N
  std::size_t interior_grains = 0;      ///< N_inves, at least 1.5 d from the wall surfaces
  double phi = 0;                       ///< Eq. S4 over interior grains
  double phi_uncorrected = 0;           ///< phi_u, Eq. S2 over interior grains
  double crystalline_percent = 0;       ///< of interior grains [%]
  double fcc_percent = 0;               ///< of interior grains [%]
  double hcp_percent = 0;               ///< of interior grains [%]
  double mean_overlap = 0;              ///< Eq. S3 over all pairs of grains [d]
  double contacts_per_grain = 0;        ///< with grains and wall grains, over all grains
  std::size_t crystallites = 0;         ///< of interior grains
  std::size_t largest_crystallite = 0;  ///< grains in it
};

/// One entry per grain, by grain id.
struct GrainMeasures {
  std::vector<double> cell_volume;      ///< [d^3]
  std::vector<double> cell_surface;     ///< [d^2]
  std::vector<double> largest_overlap;  ///< delta_max,i [d]
  std::vector<std::int32_t> contacts;   ///< with grains and wall grains
  std::vector<double> phi_local;
  std::vector<double> q6;
  std::vector<Structure> structure;    ///< of every grain, near the walls too
  std::vector<std::uint8_t> interior;  ///< 1 or 0
  Crystallites crystallites;           ///< of crystalline interior grains
};

struct Analysis {
  PackingMeasures measures;
  Mechanics mechanics;
  GrainMeasures grains;
  CrystalliteMap crystallites;  ///< where they are
};

/// Measures of a packing and of each of its grains. Throws AnalysisError as voronoi() does, and for
/// a cell less than 1 d deep, which no engine takes.
Analysis analyse(const Checkpoint& checkpoint);

/// Mean of the finite values of interior grains; not a number without such values.
template <class Value>
double interior_mean(const GrainMeasures& grains, const Value& value_of) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < grains.interior.size(); ++i) {
    const double value = grains.interior[i] != 0 ? value_of(i) : std::nan("");
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return sum / count;
}

/// Share of the interior grains for which `holds` [%]; not a number without interior grains.
template <class Predicate>
double percent_of_interior(const GrainMeasures& grains, const Predicate& holds) {
  return interior_mean(grains, [&](std::size_t i) { return holds(i) ? 100 : 0; });
}

/// Crystallites of the crystalline interior grains. Faces connect two grains if their area is at
/// least this share of the mean cell surface of interior grains.
Crystallites crystallites_of(const GrainMeasures& grains, const VoronoiDiagram& diagram,
                             double least_share);

}  // namespace shearcell
