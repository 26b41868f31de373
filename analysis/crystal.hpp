// SPDX-License-Identifier: GPL-3.0-or-later
// Bond order of grains, which grains are crystalline, and crystallites. Supplement A.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/voronoi.hpp"

namespace shearcell {

/// q6 of one cell, Eq. S1:
///
///   q6 = sqrt( (4 pi / 13) sum_{m=-6..6} | sum_j (A_ij / A_i) Y_6m(bond i -> j) |^2 ).
///
/// Bonds connect a grain to grains and wall grains. A wall plane adds no bond, but its face is part
/// of the cell surface A_i. Perfect lattices have q6 = 0.57452 (FCC), 0.48476 (HCP), 0.56694 (BCC)
/// and 0.35355 (simple cubic).
double bond_order_q6(std::span<const VoronoiFace> faces, double surface);

/// Limits for crystalline grains: Rietz et al., Phys. Rev. Lett. 120, 055701 (2018); supplement A.
inline constexpr double crystalline_phi_local = 0.72;  ///< lower limit of phi_local
inline constexpr double q6_fcc = 0.575;
inline constexpr double q6_hcp = 0.485;
inline constexpr double q6_tolerance = 0.02;  ///< upper limit of |q6 - q6_fcc| or |q6 - q6_hcp|
/// Smallest area of a Voronoi face that connects two crystalline grains, as a fraction of the mean
/// surface area of the Voronoi cells.
inline constexpr double connecting_face = 0.01;

enum class Structure : std::uint8_t { disordered, fcc, hcp };

Structure structure(double phi_local, double q6, double least_phi_local = crystalline_phi_local,
                    double tolerance = q6_tolerance);

/// Finds the connected sets of grains with crystalline[i] != 0. Two such grains are connected if
/// they share a Voronoi face of at least `least_face` [d^2]. A single grain can be a crystallite.
/// Returns for each grain the index of its crystallite, or -1 if the grain is in no crystallite.
/// Crystallites are ordered by lowest grain id.
std::vector<std::int32_t> crystallites(const VoronoiDiagram& diagram,
                                       std::span<const std::uint8_t> crystalline,
                                       double least_face);

/// The crystallites of one checkpoint, with their centres and grains. Measures contain this map, so
/// that crystallites can be followed from checkpoint to checkpoint.
struct CrystalliteMap {
  std::vector<std::int32_t> grain = {};      ///< ids of the crystalline interior grains, ascending
  std::vector<std::int32_t> label = {};      ///< label[i]: index of the crystallite of grain[i]
  std::vector<std::int32_t> size = {};       ///< grains in each crystallite
  std::vector<Eigen::Vector3d> centre = {};  ///< centre of mass of each crystallite [d]
  double width = 0;                          ///< width of the cell [d]
  double bottom = 0;                         ///< y of the bottom plane [d]
  double top = 0;                            ///< y of the top plane [d]

  std::int32_t largest() const {  ///< grains in the largest crystallite; 0 if there is none
    return size.empty() ? 0 : std::ranges::max(size);
  }
};

/// `crystallite`: the index of each grain's crystallite, from crystallites(). Centres refer to the
/// untilted cell: the displacement of the side walls at the height of each grain is subtracted from
/// its x, so that 0 <= x <= width. The z of a centre is a circular mean in [0, depth), because
/// the cell is periodic along z. This mean is accurate for crystallites much smaller than the
/// depth.
CrystalliteMap crystallite_map(std::span<const std::int32_t> crystallite, const Cell& cell,
                               const WallPose& pose, const Eigen::Matrix3Xd& positions);

}  // namespace shearcell
