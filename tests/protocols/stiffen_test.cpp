// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffening uses the stated spring constants, ends each at rest, and continues from any of its
// states.
#include "protocols/stiffen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/protocols/packings.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

const StiffenParameters kNine{};

const Packing& settled() {
  static const Packing packing = [] {
    Packing p = loose(rough_geometry(203), table_1());
    settle(p);
    p.state.step = 0;
    return p;
  }();
  return packing;
}

struct Reached {
  Scene scene;
  State state;
  StageProgress progress;
};

std::vector<Reached> stiffened(const State& from, std::uint64_t most_steps = kAtOnce) {
  const Protocol protocol = stiffen(kNine, settled().scene);
  Simulation simulation(settled().cell, settled().scene, from);
  std::vector<Reached> stops;
  do {
    const StageProgress progress = protocol.advance(simulation, most_steps);
    stops.push_back({simulation.scene(), simulation.state(), progress});
  } while (!stops.back().progress.finished);
  return stops;
}

const std::vector<Reached>& nine() {
  static const std::vector<Reached> stops = stiffened(settled().state);
  return stops;
}

TEST(Stiffen, RaisesByTheSameFactorUpToWholeDecades) {
  for (const std::uint64_t m : {1U, 2U, 3U, 4U, 7U, 100U}) {
    for (std::uint64_t n = 0; n <= 3 * m; ++n) {
      const double expected = 654 * std::pow(10.0, static_cast<double>(n) / static_cast<double>(m));
      EXPECT_NEAR(raised_stiffness(654, n, m) / expected, 1, 1e-13) << n << "/" << m;
    }
    EXPECT_EQ(raised_stiffness(654, 2 * m, m), 65400);
  }
  // Pinned: the same digits on every machine.
  EXPECT_EQ(raised_stiffness(1, 1, 4), 0x1.c73d51c54470ep+0);
}

TEST(Stiffen, IsAtRestAtEachOfNineStiffnesses) {
  ASSERT_EQ(nine().size(), 9U);
  double before = 1;
  for (std::size_t n = 0; n < 9; ++n) {
    const auto& [scene, state, progress] = nine()[n];
    EXPECT_EQ(progress.cycle, static_cast<double>(n + 1));
    EXPECT_TRUE(progress.checkpoint_due);
    EXPECT_EQ(progress.finished, n == 8);
    EXPECT_NEAR(scene.stiffness / settled().scene.stiffness,
                std::pow(10, static_cast<double>(n) / 4), 1e-11);
    EXPECT_EQ(state.step, n + 1);
    EXPECT_EQ(state.velocity.norm(), 0);
    const double residual = force_residual(settled().cell, scene, state);
    const Diagnostics facts =
        diagnose(settled().cell, scene, state, wall_pose(settled().cell, 0, state.wall_height));
    std::printf(
        "k/k0 %6.2f: residual %.2g, mean overlap %.3g, contacts a grain %.2f, height %.4f\n",
        scene.stiffness / settled().scene.stiffness, residual, facts.mean_overlap,
        facts.contacts_per_grain, settled().cell.top - state.wall_height);
    EXPECT_LE(residual, 1.001 * kNine.minimize.force_tolerance);
    EXPECT_LT(facts.mean_overlap, before);
    before = facts.mean_overlap;
  }
  EXPECT_LT(before, 1e-4);
}

TEST(Stiffen, ContinuesFromAnyStateAndInAnyChunks) {
  const State& end = nine().back().state;
  for (const std::size_t n : {0U, 4U, 7U}) {
    EXPECT_TRUE(same_bits(stiffened(nine()[n].state, 3).back().state, end)) << n;
  }
  EXPECT_TRUE(same_bits(stiffened(end).back().state, end)) << "nothing is left to do";
}

}  // namespace
}  // namespace shearcell
