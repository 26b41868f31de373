// SPDX-License-Identifier: GPL-3.0-or-later
// How the crystalline grains and crystallites depend on the criteria of supplement A.
#pragma once

#include <vector>

#include "analysis/measures.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// Values of one criterion, and what they give while the others stay.
struct Sensitivity {
  std::vector<double> criterion, result;
};

/// Crystalline grains among interior grains [%] against the half width of the window of q6.
Sensitivity crystalline_by_window(const GrainMeasures& grains);

/// The same against the threshold of phi_local.
Sensitivity crystalline_by_phi_local(const GrainMeasures& grains);

/// Grains in the largest crystallite against the least connecting face, as a share of the mean
/// surface of a cell. Finds the Voronoi cells again.
Sensitivity largest_by_face(const Checkpoint& checkpoint, const GrainMeasures& grains);

}  // namespace shearcell
