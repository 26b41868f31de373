// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "analysis/voronoi.hpp"

namespace shearcell {
namespace {

double crystalline_percent(const GrainMeasures& grains, double least_phi_local, double window) {
  double count = 0, crystalline = 0;
  for (std::size_t i = 0; i < grains.interior.size(); ++i) {
    if (grains.interior[i] == 0) continue;
    ++count;
    const double distance =
        std::min(std::abs(grains.q6[i] - q6_fcc), std::abs(grains.q6[i] - q6_hcp));
    if (grains.phi_local[i] > least_phi_local && distance < window) ++crystalline;
  }
  return 100 * crystalline / count;
}

}  // namespace

Sensitivity crystalline_by_window(const GrainMeasures& grains) {
  Sensitivity found;
  for (int n = 1; n <= 20; ++n) {
    found.criterion.push_back(n * 0.1 * q6_tolerance);
    found.result.push_back(
        crystalline_percent(grains, crystalline_phi_local, found.criterion.back()));
  }
  return found;
}

Sensitivity crystalline_by_phi_local(const GrainMeasures& grains) {
  Sensitivity found;
  for (int n = -16; n <= 8; ++n) {
    found.criterion.push_back(crystalline_phi_local + n * 0.0025);
    found.result.push_back(crystalline_percent(grains, found.criterion.back(), q6_tolerance));
  }
  return found;
}

Sensitivity largest_by_face(const Checkpoint& checkpoint, const GrainMeasures& grains) {
  const WallPose pose = wall_pose(checkpoint.cell, checkpoint.theta, checkpoint.state.wall_height);
  const VoronoiDiagram diagram = voronoi(checkpoint.cell, pose, checkpoint.state.position);
  std::vector<std::uint8_t> crystalline(grains.interior.size());
  double surface = 0, count = 0;
  for (std::size_t i = 0; i < crystalline.size(); ++i) {
    if (grains.interior[i] == 0) continue;
    crystalline[i] = grains.structure[i] == Structure::disordered ? 0 : 1;
    surface += grains.cell_surface[i];
    ++count;
  }
  Sensitivity found;
  for (const double share : {0.0, 0.0025, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06}) {
    found.criterion.push_back(share);
    // crystallites() has connecting_face as its share of a surface.
    const double scaled = share / connecting_face * surface / count;
    found.result.push_back(crystallites(diagram, crystalline, scaled).largest);
  }
  return found;
}

}  // namespace shearcell
