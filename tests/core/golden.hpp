// SPDX-License-Identifier: GPL-3.0-or-later
// States that every build of the engine must reach on every machine, to the last bit.
#pragma once

#include <array>
#include <cstdio>

#include "core/bits_version.hpp"
#include "core/minimizer.hpp"
#include "tests/core/scenes.hpp"

namespace shearcell::test {

/// A cell of 600 grains that is sheared for 700 steps.
inline State sheared(const SimulationSettings& settings) {
  static const Sheared start = pressed(600, 9000);
  return advanced(start, 700, settings);
}

/// The pressed packing whose enthalpy the tests minimize.
inline const Sheared& small_packing() {
  static const Sheared packing = pressed(203, 20000);
  return packing;
}

inline State minimized(const SimulationSettings& settings) {
  Simulation simulation(small_packing().cell, table_1(), small_packing().state, settings);
  minimize_enthalpy(simulation, {.force_tolerance = 1e-5});
  return simulation.state();
}

/// Deep overlaps take the closed form of the contact law; lanes beside them must not notice.
inline State deep_and_shallow(const SimulationSettings& settings) {
  Sheared start{open_cell(), {}};
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 40; ++i) {
    const double x = 5 + 3 * (i % 8), y = 5 + 3 * (i / 8);
    positions.emplace_back(x, y, 10);
    positions.emplace_back(x + (i % 3 == 0 ? 0.5 : 0.99), y, 10);
  }
  start.state = at_rest(positions, start.cell);
  SimulationSettings any_overlap = settings;
  any_overlap.limits.overlap = 1;
  return advanced(start, 200, any_overlap);
}

/// The fingerprints of one version of the bits: of sheared, minimized and deep_and_shallow.
struct VersionedBits {
  std::uint64_t version;
  std::array<std::uint64_t, 3> fingerprints;
};

/// A line never changes: states of its version are in stores. Whoever changes bits raises
/// `bits_version` and adds a line with the new fingerprints, which the failing test prints.
/// (Version 1 had none.)
inline constexpr std::array kBits = {
    VersionedBits{2, {0x1d65753234f77d8bU, 0xc450a98c9f1b8643U, 0x001eb85ecd807cacU}}};
static_assert(kBits.back().version == bits_version);

struct Golden {
  const char* name;
  State (*compute)(const SimulationSettings& settings);
  std::uint64_t fingerprint;
};

inline constexpr std::array kGolden = {
    Golden{"sheared", sheared, kBits.back().fingerprints[0]},
    Golden{"minimized", minimized, kBits.back().fingerprints[1]},
    Golden{"deep", deep_and_shallow, kBits.back().fingerprints[2]}};

/// Whether each kernel of this machine reaches the state; prints those that do not.
inline bool is_reached(const Golden& golden) {
  bool all = true;
  for (const Kernels* kernels : kernels_here()) {
    SimulationSettings settings;
    settings.kernels = kernels;
    const std::uint64_t found = fingerprint(golden.compute(settings));
    if (found == golden.fingerprint) continue;
    std::printf("%s on %s: %#llx. If this change of bits is meant, raise bits_version\n",
                golden.name, kernels->name, static_cast<unsigned long long>(found));
    all = false;
  }
  return all;
}

}  // namespace shearcell::test
