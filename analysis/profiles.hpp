// SPDX-License-Identifier: GPL-3.0-or-later
// Measures against the height above the bottom wall and the distance from the nearest wall, and
// against the criteria of supplement A.
#pragma once

#include <vector>

#include "analysis/measures.hpp"

namespace shearcell {

/// One entry per layer of one diameter, from the plane of the bottom wall to the plane of the top
/// wall. Grains count in the layer of their centre if they are at least 1.5 d from the surfaces of
/// the side walls. Values of a layer without grains are not numbers.
struct Profiles {
  std::vector<double> height;               ///< of the layer's middle [d]
  std::vector<double> phi;                  ///< Eq. S4
  std::vector<double> pressure;             ///< of contacts, over the cells' volumes [k/d]
  std::vector<double> coordination;         ///< contacts with grains and wall grains
  std::vector<double> crystalline_percent;  ///< [%]
};

Profiles profiles(const Checkpoint& checkpoint, const GrainMeasures& grains);

/// phi (Eq. S4) of layers of half a diameter against the distance of their middle from the nearest
/// wall surface [d]. Not a number for a layer without grains.
MeasuredCurve phi_by_wall_distance(const Checkpoint& checkpoint, const GrainMeasures& grains);

/// The grains at least core_distance from the walls.
struct Core {
  double grains = 0;
  double phi = 0;  ///< Eq. S4; not a number without any
};
Core core(const Checkpoint& checkpoint, const GrainMeasures& grains);

/// Crystalline grains among interior grains [%] against the half width of the window of q6; the
/// other criteria stay.
MeasuredCurve crystalline_by_window(const GrainMeasures& grains);

/// Crystalline grains among interior grains [%] against the threshold of phi_local.
MeasuredCurve crystalline_by_phi_local(const GrainMeasures& grains);

/// Grains in the largest crystallite against the least connecting face, as a share of the mean
/// surface of a cell. Finds the Voronoi cells again.
MeasuredCurve largest_by_face(const Checkpoint& checkpoint, const GrainMeasures& grains);

}  // namespace shearcell
