// SPDX-License-Identifier: GPL-3.0-or-later
// Bond order, which grains are crystalline, and the crystallites that they form. Supplement A.
#pragma once

#include <Eigen/Core>
#include <cstdint>
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

/// Criteria of Rietz et al., Phys. Rev. Lett. 120, 055701 (2018), as in supplement A.
inline constexpr double crystalline_phi_local = 0.72;  ///< phi_local is above this
inline constexpr double q6_fcc = 0.575;
inline constexpr double q6_hcp = 0.485;
inline constexpr double q6_tolerance = 0.02;  ///< |q6 - q6_fcc| or |q6 - q6_hcp| is below this
/// Two crystalline grains are connected by a face of at least this share of the mean cell surface.
inline constexpr double connecting_face = 0.01;

enum class Structure : std::uint8_t { disordered, fcc, hcp };

Structure structure(double phi_local, double q6, double least_phi_local = crystalline_phi_local,
                    double tolerance = q6_tolerance);

struct Crystallites {
  /// Crystallite of each grain, -1 for none. Numbered in the order of their lowest grain id.
  std::vector<std::int32_t> label;
  std::vector<std::int32_t> size;  ///< grains in each crystallite
  std::int32_t largest = 0;        ///< grains in the largest one; 0 without crystallites
};

/// Sets of grains with `crystalline[i] != 0` that are connected through Voronoi faces between two
/// of them of at least `least_face` [d^2]. One grain alone is a crystallite of size 1.
Crystallites crystallites(const VoronoiDiagram& diagram, std::span<const std::uint8_t> crystalline,
                          double least_face);

/// The crystallites of one checkpoint with their centres and grains. The measures keep this map, so
/// that crystallites can be followed from checkpoint to checkpoint.
struct CrystalliteMap {
  std::vector<std::int32_t> grain;      ///< ids of the crystalline interior grains, ascending
  std::vector<std::int32_t> label;      ///< crystallite of each of these grains
  std::vector<std::int32_t> size;       ///< grains in each crystallite
  std::vector<Eigen::Vector3d> centre;  ///< of mass of each crystallite [d]; see crystallite_map()
  double width = 0;                     ///< of the cell [d]
  double bottom = 0;                    ///< heights of the horizontal planes [d]
  double top = 0;
};

/// Centres are in the untilted cell: the displacement of the walls at that height is subtracted
/// from x, so that 0 <= x <= width. z is a circular mean over the period, in [0, depth): exact for
/// crystallites that are small compared with the period.
CrystalliteMap crystallite_map(const Crystallites& crystallites, const Cell& cell,
                               const WallPose& pose, const Eigen::Matrix3Xd& positions);

}  // namespace shearcell
