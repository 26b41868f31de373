// SPDX-License-Identifier: GPL-3.0-or-later
// The same bits whatever the instructions, the lists, the threads and the compiler.
#include <gtest/gtest.h>

#include "tests/core/scenes.hpp"

namespace shearcell {
namespace {

using test::advanced;
using test::pressed;
using test::same_bits;
using test::Sheared;

TEST(Reproducible, AnyInstructionsAndAnyLists) {
  const Sheared start = pressed(601, 9000);
  const State golden = advanced(start, 700);
  for (const Simd simd : kEverySimd) {
    if (find_kernels(simd) == nullptr) continue;
    for (const double inner : {1.03, 1.05, 1.1, 1.2, 1.3}) {
      EngineSettings settings;
      settings.kernels = find_kernels(simd);
      settings.lists.inner_cutoff = inner;
      settings.lists.outer_cutoff = settings.lists.widest_cutoff = inner + 0.05;
      EXPECT_TRUE(same_bits(golden, advanced(start, 700, settings)))
          << find_kernels(simd)->name << " at cutoff " << inner;
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

// The same number from every build: g++ and clang++, optimized or not.
TEST(Reproducible, TheBitsOfTheReferenceBuild) {
  const State state = advanced(pressed(600, 9000), 700);
  EXPECT_EQ(test::fingerprint(state), 0x1d65753234f77d8bU) << std::hex << test::fingerprint(state);
}

// Deep overlaps take the closed form of the contact law; lanes beside them must not notice.
TEST(Reproducible, DeepAndShallowOverlapsSideBySide) {
  Sheared start{test::open_cell(), {}};
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 40; ++i) {
    positions.emplace_back(5 + 3 * (i % 8), 5 + 3 * (i / 8), 10);
    positions.emplace_back(5 + 3 * (i % 8) + (i % 3 == 0 ? 0.5 : 0.99), 5 + 3 * (i / 8), 10);
  }
  start.state = test::at_rest(positions, start.cell);
  EngineSettings best;
  best.limits.overlap = 1;
  EngineSettings scalar = best;
  scalar.kernels = &scalar_kernels();
  EXPECT_TRUE(same_bits(advanced(start, 200, best), advanced(start, 200, scalar)));
}

}  // namespace
}  // namespace shearcell
