// SPDX-License-Identifier: GPL-3.0-or-later
// A program that uses the installed libraries: settles a small packing, shears it for a twentieth
// of a cycle, and measures it.
#include <analysis/analyse.hpp>
#include <cstdio>
#include <experiments/manifest/conversion.hpp>
#include <protocols/settle.hpp>

int main() {
  using namespace shearcell;
  Parameters parameters;
  parameters.grains = 300;
  Cell cell = make_cell(geometry(parameters), 1);
  const State loose = fill_cell(cell, geometry(parameters), 1);
  const State packing = pressed(cell, loose, settle_scene(parameters));
  const WallPose pose = wall_pose(cell, 0, packing.wall_height);
  Eigen::Matrix3Xd grains = packing.position;
  const PackingMeasures measures = analyse(cell, pose, grains).measures;
  std::printf("%zu grains, %.2f contacts per grain\n", measures.grains,
              measures.contacts_per_grain);
  return measures.grains == 300 && measures.contacts_per_grain > 4 ? 0 : 1;
}
