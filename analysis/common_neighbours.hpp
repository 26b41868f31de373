// SPDX-License-Identifier: GPL-3.0-or-later
// A second definition of crystalline grains, by the bonds among a grain's nearest neighbours.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/cell.hpp"

namespace shearcell {

enum class Lattice : std::uint8_t { none, fcc, hcp, bcc };

/// Adaptive common neighbour analysis (Stukowski, Modelling Simul. Mater. Sci. Eng. 20, 045021
/// (2012)) of each of `grains` (3 x n [d], z unwrapped). Wall grains are neighbours too. FCC and
/// HCP are decided by the 12 nearest neighbours, with bonds up to (1 + sqrt 2) / 2 times their mean
/// distance, BCC by 14. A grain with fewer neighbours within 1.5 d is in no lattice.
std::vector<Lattice> common_neighbour_analysis(const Cell& cell, const WallPose& pose,
                                               const Eigen::Matrix3Xd& grains);

}  // namespace shearcell
