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
  Checkpoint packing;
  packing.cell = make_cell(geometry(parameters), 1);
  const State loose = fill_cell(packing.cell, geometry(parameters), 1);
  packing.state = pressed(packing.cell, loose, settle_scene(parameters));
  const PackingMeasures measures = analyse(packing).measures;
  std::printf("%zu grains, %.2f contacts per grain\n", measures.grains,
              measures.contacts_per_grain);
  return measures.grains == 300 && measures.contacts_per_grain > 4 ? 0 : 1;
}
