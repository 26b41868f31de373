// SPDX-License-Identifier: GPL-3.0-or-later
// The bond-orientational order q6 of each grain, each bond weighted by its Voronoi face.
#pragma once

#include <span>
#include <vector>

#include "analysis/voronoi.hpp"

namespace shearcell {

/// q6 of one cell, Eq. S1:
///
///   q6 = sqrt( (4 pi / 13) sum_{m=-6..6} | sum_j (A_ij / A_i) Y_6m(bond i -> j) |^2 ).
///
/// Bonds go to grains and wall grains. A wall plane has no grain behind it and so no bond, but its
/// face is part of the cell's whole surface A_i. Perfect FCC 0.57452, HCP 0.48476, BCC 0.56694,
/// simple cubic 0.35355.
double bond_order_q6(std::span<const VoronoiFace> faces, double surface);

/// q6 of every grain, by grain id.
std::vector<double> bond_order_q6(const VoronoiDiagram& diagram);

}  // namespace shearcell
