// SPDX-License-Identifier: GPL-3.0-or-later
// The same bits with any instructions, lists, threads and compiler.
#include <gtest/gtest.h>

#include "tests/core/golden.hpp"

namespace shearcell {
namespace {

// tests/bits.sh compares other builds with these: g++ and clang++, optimized or not, and NEON.
TEST(Reproducible, TheBitsOfTheReferenceBuildOnEveryKernel) {
  for (const test::Golden& golden : test::kGolden) EXPECT_TRUE(is_reached(golden)) << golden.name;
}

// Two versions with equal bits, or a version that was left out, would forbid what is possible.
TEST(Reproducible, EachVersionOfTheBitsHasItsOwn) {
  for (std::size_t k = 1; k < test::kBits.size(); ++k) {
    EXPECT_EQ(test::kBits[k].version, test::kBits[k - 1].version + 1);
    EXPECT_NE(test::kBits[k].fingerprints, test::kBits[k - 1].fingerprints);
  }
}

// Any cutoffs and kernels, on random scenes: EqualsBruteForceOverAllPairs and
// tests/provenance/restart_property_test.cpp.
TEST(Reproducible, AnyThreadsAndAnyLists) {
  SimulationSettings two, three, always, unsorted;
  two.threads = 2;
  three.threads = 3;
  always.lists.rebuild_every_step = true;
  unsorted.lists.sort_memory = false;
  for (const test::Golden& golden : test::kGolden) {
    for (const SimulationSettings& settings : {two, three, always, unsorted}) {
      EXPECT_EQ(test::fingerprint(golden.compute(settings)), golden.fingerprint)
          << golden.name << ", " << settings.threads
          << " threads, rebuilt every step: " << settings.lists.rebuild_every_step
          << ", sorted: " << settings.lists.sort_memory;
    }
  }
}

}  // namespace
}  // namespace shearcell
