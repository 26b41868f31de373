// SPDX-License-Identifier: GPL-3.0-or-later
// A few numbers of a packing, and their means over seeds from one engine beside another's.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/statistics.hpp"
#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

struct PackingNumbers {
  double phi = 0;        ///< Eq. S4
  double contacts = 0;   ///< per grain
  double overlap = 0;    ///< mean, Eq. S3 [d]
  double imbalance = 0;  ///< |P A - F| / (P A) of the moving wall
  double height = 0;     ///< of the cell [d]
};

/// Of a state at tilt `theta` [rad]. Throws AnalysisError as voronoi() does.
PackingNumbers numbers_of(const Cell& cell, const Scene& scene, double theta, const State& state);

struct EngineMean {
  std::string name;
  std::vector<RunStatistics> of;  ///< one for each engine, ours first
  /// Of each engine's mean from ours, in standard errors of that difference; 0 for ours.
  std::vector<double> apart;
};

/// Means of every number over the packings of each engine, ours first.
std::vector<EngineMean> engine_means(const std::vector<std::vector<PackingNumbers>>& of_engine);

}  // namespace shearcell
