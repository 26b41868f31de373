// SPDX-License-Identifier: GPL-3.0-or-later
// The same bits whatever the instructions, the lists, the threads and the compiler.
#include <gtest/gtest.h>

#include "tests/core/golden.hpp"

namespace shearcell {
namespace {

using test::advanced;
using test::pressed;
using test::same_bits;
using test::Sheared;

TEST(Reproducible, AnyInstructionsAndAnyLists) {
  const Sheared start = pressed(601, 9000);
  const State golden = advanced(start, 700);
  for (const Kernels* kernels : kernels_here()) {
    for (const double inner : {1.03, 1.05, 1.1, 1.2, 1.3}) {
      EngineSettings settings;
      settings.kernels = kernels;
      settings.lists.inner_cutoff = inner;
      settings.lists.outer_cutoff = settings.lists.widest_cutoff = inner + 0.05;
      EXPECT_TRUE(same_bits(golden, advanced(start, 700, settings)))
          << kernels->name << " at cutoff " << inner;
    }
  }
  for (const std::size_t threads : {2U, 3U}) {
    EngineSettings shared;
    shared.threads = threads;
    EXPECT_TRUE(same_bits(golden, advanced(start, 700, shared))) << threads << " threads";
  }
  EngineSettings settings;
  settings.lists.rebuild_every_step = true;
  EXPECT_TRUE(same_bits(golden, advanced(start, 700, settings))) << "rebuilt every step";
  settings = {};
  settings.lists.sort_memory = false;
  EXPECT_TRUE(same_bits(golden, advanced(start, 700, settings))) << "memory not sorted";
}

// tests/bits.sh compares other builds with these: g++ and clang++, optimized or not, and NEON.
TEST(Reproducible, TheBitsOfTheReferenceBuildOnEveryKernel) {
  for (const test::Golden& golden : test::kGolden) EXPECT_TRUE(is_reached(golden)) << golden.name;
}

}  // namespace
}  // namespace shearcell
