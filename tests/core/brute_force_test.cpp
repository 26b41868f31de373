// SPDX-License-Identifier: GPL-3.0-or-later
// The time loop against a sum over all pairs without lists, bit for bit.
#include <gtest/gtest.h>

#include "tests/core/random_scenes.hpp"
#include "tests/support/all_pairs.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

PROPERTY(Reproducible, EqualsBruteForceOverAllPairs, 60) {
  const Sheared start = any_packing(200);
  const Scene scene = any_scene();
  const Drive drive = any_drive();
  const auto steps = *rc::gen::inRange<std::uint64_t>(1, 120).as("steps");
  const SimulationSettings settings = any_settings();
  State brute = start.state;
  for (std::uint64_t n = 0; n < steps; ++n) step_over_all_pairs(start.cell, scene, drive, brute);
  RC_ASSERT(same_bits(brute, advanced(start, steps, settings, scene, drive)));
}

}  // namespace
}  // namespace shearcell
