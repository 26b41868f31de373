// SPDX-License-Identifier: GPL-3.0-or-later
// Which grains are crystalline, and the crystallites that they form. Supplement A.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/voronoi.hpp"

namespace shearcell {

/// Criteria of Rietz et al., Phys. Rev. Lett. 120, 055701 (2018), as in supplement A.
inline constexpr double crystalline_phi_local = 0.72;  ///< phi_local is above this
inline constexpr double q6_fcc = 0.575;
inline constexpr double q6_hcp = 0.485;
inline constexpr double q6_tolerance = 0.02;  ///< |q6 - q6_fcc| or |q6 - q6_hcp| is below this
/// Two crystalline grains are connected by a face of at least this share of the mean cell surface.
inline constexpr double connecting_face = 0.01;

enum class Structure : std::uint8_t { disordered, fcc, hcp };

Structure structure(double phi_local, double q6);

struct Crystallites {
  /// Crystallite of each grain, -1 for none. Numbered in the order of their lowest grain id.
  std::vector<std::int32_t> label;
  std::vector<std::int32_t> size;  ///< grains in each crystallite
  std::int32_t largest = 0;        ///< grains in the largest; 0 when there is none
};

/// Sets of grains with `crystalline[i] != 0` that are connected through Voronoi faces between two
/// of them of area >= connecting_face * mean_surface [d^2]. One grain alone is a crystallite of
/// size 1.
Crystallites crystallites(const VoronoiDiagram& diagram, std::span<const std::uint8_t> crystalline,
                          double mean_surface);

}  // namespace shearcell
