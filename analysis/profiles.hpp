// SPDX-License-Identifier: GPL-3.0-or-later
// Measures as functions of the height above the bottom wall.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/measures.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// One entry per layer of one diameter, from the plane of the bottom wall up to that of the top
/// wall. A layer has the grains whose centres are in it, at least 1.5 d from the surfaces of the
/// side walls; without any, its values are not numbers.
struct Profiles {
  std::vector<double> height;               ///< of the layer's middle [d]
  std::vector<double> phi;                  ///< Eq. S4
  std::vector<double> pressure;             ///< of contacts, over the cells' volumes [k/d]
  std::vector<double> coordination;         ///< contacts with grains and wall grains
  std::vector<double> crystalline_percent;  ///< [%]
};

Profiles profiles(const Checkpoint& checkpoint, const GrainMeasures& grains);

}  // namespace shearcell
